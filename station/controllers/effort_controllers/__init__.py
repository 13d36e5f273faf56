"""Controllers over `EffortJointInterface`."""

from station.controllers.effort_controllers.joint_effort_controller import (
    JointEffortController,
)
from station.controllers.effort_controllers.joint_group_effort_controller import (
    JointGroupEffortController,
)
from station.controllers.effort_controllers.joint_group_position_controller import (
    JointGroupPositionController,
)
from station.controllers.effort_controllers.joint_position_controller import (
    JointPositionController,
)
from station.controllers.effort_controllers.joint_velocity_controller import (
    JointVelocityController,
)

__all__ = [
    "JointEffortController",
    "JointGroupEffortController",
    "JointGroupPositionController",
    "JointPositionController",
    "JointVelocityController",
]
