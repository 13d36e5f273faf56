"""Execute trajectories of joints over any joint command interface."""

from station.controllers.joint_trajectory_controller.follow_joint_trajectory_goal import (  # noqa: E501
    ErrorCode,
)
from station.controllers.joint_trajectory_controller.joint_trajectory_controller import (  # noqa: E501
    EffortJointTrajectoryController,
    JointTrajectoryController,
    JointTrajectoryState,
    PositionJointTrajectoryController,
    PosVelAccJointTrajectoryController,
    PosVelJointTrajectoryController,
    VelocityJointTrajectoryController,
)

__all__ = [
    "EffortJointTrajectoryController",
    "ErrorCode",
    "JointTrajectoryController",
    "JointTrajectoryState",
    "PosVelAccJointTrajectoryController",
    "PosVelJointTrajectoryController",
    "PositionJointTrajectoryController",
    "VelocityJointTrajectoryController",
]
