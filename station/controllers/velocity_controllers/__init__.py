"""Controllers over `VelocityJointInterface`."""

from station.controllers.velocity_controllers.joint_group_velocity_controller import (
    JointGroupVelocityController,
)

__all__ = ["JointGroupVelocityController"]
