"""Forward the set-point of every joint to the hardware.

Source: ros_controllers@678b92a forward_command_controller/forward_command_controller.h,
forward_joint_group_command_controller.h.
"""

from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
    JointSetPointController,
)
from station.core.control.controller import ControllerSample


class ForwardJointGroupCommandController(JointSetPointController[CommandInterfaceT]):
    """Writes the set-point to the command interface as it is.

    Parameters: `joints`, the names of the joints in the order of the set-points, and
    those of the base class.

    Source:
        ForwardJointGroupCommandController; differs: a set-point beyond the limits of
        the robot description is refused.
    """

    @override
    def update(self, time: float, period: float) -> None:
        set_point = self.newest_set_point()
        self.group.set_commands(set_point)
        actual = self.quantity.measure(self.group)
        self.sample = ControllerSample(
            time,
            set_point,
            actual,
            [d - a for d, a in zip(set_point, actual, strict=True)],
            set_point,
        )


class ForwardCommandController(ForwardJointGroupCommandController[CommandInterfaceT]):
    """Writes the set-point of one joint to the command interface as it is.

    Parameters: `joint`, the name of the joint, and those of the base class.
    """

    is_group: ClassVar[bool] = False
