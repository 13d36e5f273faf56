"""Trajectories of joints: requests, segments, tolerances, and how they are joined."""

from station.core.trajectory.init_joint_trajectory import (
    JointSegments as JointSegments,
    JointTrajectory as JointTrajectory,
    JointTrajectoryPoint as JointTrajectoryPoint,
    JointTrajectorySegment as JointTrajectorySegment,
    SegmentTrajectory as SegmentTrajectory,
    TrajectoryOptions as TrajectoryOptions,
    braking_trajectory as braking_trajectory,
    check_joint_names as check_joint_names,
    find_segment as find_segment,
    hold_trajectory as hold_trajectory,
    init_joint_trajectory as init_joint_trajectory,
    sample_segments as sample_segments,
    stop_trajectory as stop_trajectory,
    wraparound_offset as wraparound_offset,
)
from station.core.trajectory.quintic_spline_segment import (
    PosVelAccState as PosVelAccState,
    QuinticSplineSegment as QuinticSplineSegment,
    peak_speeds as peak_speeds,
    through_waypoints as through_waypoints,
)
from station.core.trajectory.tolerances import (
    TOLERANCE_PARAMETERS as TOLERANCE_PARAMETERS,
    JointTolerances as JointTolerances,
    StateTolerances as StateTolerances,
    ToleranceRequest as ToleranceRequest,
    read_tolerances as read_tolerances,
    updated_tolerances as updated_tolerances,
)
