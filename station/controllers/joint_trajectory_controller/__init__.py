"""Execute trajectories of joints over any joint command interface."""

from station.controllers.joint_trajectory_controller.controller import (
    EffortJointTrajectoryController,
    JointTrajectoryController,
    JointTrajectoryState,
    PositionJointTrajectoryController,
    PosVelAccJointTrajectoryController,
    PosVelJointTrajectoryController,
    VelocityJointTrajectoryController,
)
from station.controllers.joint_trajectory_controller.execution import ErrorCode

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
