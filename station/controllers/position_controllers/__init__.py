"""Controllers over `PositionJointInterface`."""

from station.controllers.position_controllers.joint_group_position_controller import (
    JointGroupPositionController,
)
from station.controllers.position_controllers.joint_position_controller import (
    JointPositionController,
)

__all__ = [
    "JointGroupPositionController",
    "JointPositionController",
]
