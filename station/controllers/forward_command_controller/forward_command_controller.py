"""Pass the set-point of one joint on to the hardware.

Source: ros_controllers@678b92a forward_command_controller/forward_command_controller.h.
"""

from typing import ClassVar

from station.controllers.forward_command_controller.forward_joint_group_command_controller import (  # noqa: E501
    ForwardJointGroupCommandController,
)
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
)


class ForwardCommandController(ForwardJointGroupCommandController[CommandInterfaceT]):
    """Commands one joint what it was told.

    Parameters: `joint`, the name of the joint.
    """

    is_group: ClassVar[bool] = False
