"""Controllers over `EffortJointInterface`."""

from station.controllers.effort_controllers.joint_group_effort_controller import (
    JointGroupEffortController,
)
from station.controllers.effort_controllers.joint_group_position_controller import (
    JointGroupPositionController,
)

__all__ = ["JointGroupEffortController", "JointGroupPositionController"]
