"""Controllers that command velocities; the robot tracks them.

Source: ros_controllers@678b92a velocity_controllers/src/joint_velocity_controller.cpp,
joint_group_velocity_controller.cpp, joint_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.set_point_controller import (
    ForwardCommandController,
    ForwardJointGroupCommandController,
    JointPidController,
    JointQuantity,
)
from station.core.hardware.interfaces import VelocityJointInterface


class JointVelocityController(ForwardCommandController[VelocityJointInterface]):
    """Forwards velocities to one joint; starts with zero velocity."""

    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY


class JointGroupVelocityController(
    ForwardJointGroupCommandController[VelocityJointInterface]
):
    """Forwards velocities to a group of joints; starts with zero velocity."""

    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY


class JointPositionController(JointPidController[VelocityJointInterface]):
    """Controls the position of one joint by velocities."""

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION
    command_quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
    is_group: ClassVar[bool] = False
    needs_description: ClassVar[bool] = True
