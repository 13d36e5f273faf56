"""Controllers that command efforts.

Source: ros_controllers@678b92a effort_controllers/src/joint_effort_controller.cpp,
joint_group_effort_controller.cpp, joint_position_controller.cpp,
joint_velocity_controller.cpp, joint_group_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.set_point_controller import (
    ForwardCommandController,
    ForwardJointGroupCommandController,
    JointPidController,
    JointQuantity,
)
from station.core.hardware.interfaces import EffortJointInterface


class JointEffortController(ForwardCommandController[EffortJointInterface]):
    """Forwards efforts to one joint; starts with zero effort."""

    quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT


class JointGroupEffortController(
    ForwardJointGroupCommandController[EffortJointInterface]
):
    """Forwards efforts to a group of joints; starts with zero effort."""

    quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT


class JointGroupPositionController(JointPidController[EffortJointInterface]):
    """Controls the positions of a group of joints by efforts."""

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION
    command_quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
    needs_description: ClassVar[bool] = True


class JointPositionController(JointGroupPositionController):
    """Controls the position of one joint by efforts."""

    is_group: ClassVar[bool] = False


class JointVelocityController(JointPidController[EffortJointInterface]):
    """Controls the velocity of one joint by efforts; starts with zero velocity."""

    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
    command_quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
    is_group: ClassVar[bool] = False
