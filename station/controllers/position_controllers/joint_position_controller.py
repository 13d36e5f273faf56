"""Forward position commands to one joint.

Source: ros_controllers@678b92a position_controllers/src/
joint_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import (
    ForwardCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import PositionJointInterface


class JointPositionController(ForwardCommandController[PositionJointInterface]):
    """Forwards position commands to the parameter `joint`."""

    hardware_interface: ClassVar[type] = PositionJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION
