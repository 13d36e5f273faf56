"""Drive joints by effort commands.

Source: ros_controllers@678b92a effort_controllers/src/
joint_group_effort_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import (
    ForwardJointGroupCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import EffortJointInterface


class JointGroupEffortController(
    ForwardJointGroupCommandController[EffortJointInterface]
):
    """Forwards effort commands to a group of joints; starts with zero."""

    hardware_interface: ClassVar[type] = EffortJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
