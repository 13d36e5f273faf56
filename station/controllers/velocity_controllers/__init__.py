"""Controllers over `VelocityJointInterface`."""

from station.controllers.velocity_controllers.joint_group_velocity_controller import (
    JointGroupVelocityController,
)
from station.controllers.velocity_controllers.joint_position_controller import (
    JointPositionController,
)
from station.controllers.velocity_controllers.joint_velocity_controller import (
    JointVelocityController,
)

__all__ = [
    "JointGroupVelocityController",
    "JointPositionController",
    "JointVelocityController",
]
