"""Trajectories of joints, executed over any joint command interface.

One module per package of the original in which the class is called
`JointTrajectoryController`.
"""

from station.controllers.joint_trajectory_controller.follow_joint_trajectory_goal import (  # noqa: E501
    ErrorCode,
)
from station.controllers.joint_trajectory_controller.joint_trajectory_controller import (  # noqa: E501
    JointTrajectoryControllerBase,
    JointTrajectoryState,
)

__all__ = ["ErrorCode", "JointTrajectoryControllerBase", "JointTrajectoryState"]
