"""Execute trajectories of joints over any joint command interface."""

from station.controllers.joint_trajectory_controller.controller import (
    EffortJointTrajectoryController as EffortJointTrajectoryController,
    JointTrajectoryController as JointTrajectoryController,
    JointTrajectoryState as JointTrajectoryState,
    PositionJointTrajectoryController as PositionJointTrajectoryController,
    PosVelAccJointTrajectoryController as PosVelAccJointTrajectoryController,
    PosVelJointTrajectoryController as PosVelJointTrajectoryController,
    VelocityJointTrajectoryController as VelocityJointTrajectoryController,
)
from station.controllers.joint_trajectory_controller.execution import (
    ErrorCode as ErrorCode,
)
