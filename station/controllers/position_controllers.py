"""Controllers that command positions; the robot tracks them.

Source: ros_controllers@678b92a position_controllers/src/joint_position_controller.cpp,
joint_group_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.set_point_controller import (
    ForwardCommandController,
    ForwardJointGroupCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import PositionJointInterface


class JointPositionController(ForwardCommandController[PositionJointInterface]):
    """Forwards positions to one joint; starts at its present position."""

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION


class JointGroupPositionController(
    ForwardJointGroupCommandController[PositionJointInterface]
):
    """Forwards positions to a group of joints; starts at their present positions."""

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION
