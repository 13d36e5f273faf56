"""Forward velocity commands to one joint.

Source: ros_controllers@678b92a velocity_controllers/src/
joint_velocity_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import (
    ForwardCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import VelocityJointInterface


class JointVelocityController(ForwardCommandController[VelocityJointInterface]):
    """Forwards velocity commands to the parameter `joint`."""

    hardware_interface: ClassVar[type] = VelocityJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
