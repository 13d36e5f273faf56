"""Hold or move joints by position commands; the robot tracks them.

Source: ros_controllers@678b92a position_controllers/src/
joint_group_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import (
    ForwardJointGroupCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import PositionJointInterface


class JointGroupPositionController(
    ForwardJointGroupCommandController[PositionJointInterface]
):
    """Forwards position commands to a group of joints; starts where they are."""

    hardware_interface: ClassVar[type] = PositionJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION
