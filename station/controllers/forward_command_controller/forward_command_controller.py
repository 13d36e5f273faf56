"""Forward the set-point of every joint to the hardware.

Source: ros_controllers@678b92a forward_command_controller/forward_command_controller.h,
forward_joint_group_command_controller.h.
"""

from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller.command_laws import ComparingLaw
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
    JointSetPointController,
)
from station.core.numerics.joint_errors import JointErrors
from station.core.parameters import Parameters
from station.memory.doubles import zeros


class ForwardJointGroupCommandController(JointSetPointController[CommandInterfaceT]):
    """Writes the set-point to the command interface as it is.

    Parameters: `joints`, the names of the joints in the order of the set-points, and
    those of the base class.

    Source:
        ForwardJointGroupCommandController; differs: a set-point beyond the limits of
        the robot description is refused.
    """

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        desired, actual = self._watched.desired, self.quantity.measured(self.memory)
        errors = zeros(self.memory.size)
        law = ComparingLaw(
            desired, self.memory.commands, JointErrors(desired, actual, errors)
        )
        self.follow_by(law, (desired, actual, errors, desired))


class ForwardCommandController(ForwardJointGroupCommandController[CommandInterfaceT]):
    """Writes the set-point of one joint to the command interface as it is.

    Parameters: `joint`, the name of the joint, and those of the base class.
    """

    is_group: ClassVar[bool] = False
