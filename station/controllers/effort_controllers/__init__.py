"""Controllers over `EffortJointInterface`."""

from station.controllers.effort_controllers.joint_group_effort_controller import (
    JointGroupEffortController,
)

__all__ = ["JointGroupEffortController"]
