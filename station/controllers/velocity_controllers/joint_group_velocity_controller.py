"""Move joints by velocity commands; the robot tracks them.

Source: ros_controllers@678b92a velocity_controllers/src/
joint_group_velocity_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import (
    ForwardJointGroupCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import VelocityJointInterface


class JointGroupVelocityController(
    ForwardJointGroupCommandController[VelocityJointInterface]
):
    """Forwards velocity commands to a group of joints; starts with zero."""

    hardware_interface: ClassVar[type] = VelocityJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
