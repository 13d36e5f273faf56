"""Trajectories of joints: requests, segments, tolerances, and how they are joined."""

from station.core.trajectory.init_joint_trajectory import (
    TrajectoryOptions,
    check_joint_names,
    hold_trajectory,
    init_joint_trajectory,
    stop_trajectory,
)
from station.core.trajectory.joint_trajectory import (
    JointTrajectory,
    JointTrajectoryPoint,
)
from station.core.trajectory.joint_trajectory_segment import (
    JointSegments,
    JointTrajectorySegment,
    SegmentTrajectory,
    find_segment,
    sample_segments,
    wraparound_offset,
)
from station.core.trajectory.quintic_spline_segment import (
    PosVelAccState,
    QuinticSplineSegment,
)
from station.core.trajectory.through_waypoints import peak_speeds, through_waypoints
from station.core.trajectory.tolerances import (
    TOLERANCE_PARAMETERS,
    JointTolerances,
    StateTolerances,
    ToleranceRequest,
    read_tolerances,
    updated_tolerances,
)

__all__ = [
    "TOLERANCE_PARAMETERS",
    "JointSegments",
    "JointTolerances",
    "JointTrajectory",
    "JointTrajectoryPoint",
    "JointTrajectorySegment",
    "PosVelAccState",
    "QuinticSplineSegment",
    "SegmentTrajectory",
    "StateTolerances",
    "ToleranceRequest",
    "TrajectoryOptions",
    "check_joint_names",
    "find_segment",
    "hold_trajectory",
    "init_joint_trajectory",
    "peak_speeds",
    "read_tolerances",
    "sample_segments",
    "stop_trajectory",
    "through_waypoints",
    "updated_tolerances",
    "wraparound_offset",
]
