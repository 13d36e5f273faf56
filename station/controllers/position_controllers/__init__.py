"""Controllers over `PositionJointInterface`."""

from station.controllers.position_controllers.joint_group_position_controller import (
    JointGroupPositionController,
)

__all__ = ["JointGroupPositionController"]
