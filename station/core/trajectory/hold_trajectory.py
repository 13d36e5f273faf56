"""Trajectories that end a motion: hold a position, or come to rest in a given time.

Source: ros_controllers@678b92a joint_trajectory_controller/hold_trajectory_builder.h,
stop_trajectory_builder.h.
"""

from collections.abc import Sequence

from station.core.ports.goal import Goal
from station.core.trajectory.joint_trajectory_segment import (
    JointTrajectorySegment,
    SegmentTrajectory,
)
from station.core.trajectory.quintic_spline_segment import (
    PosVelAccState,
    QuinticSplineSegment,
)


def hold_trajectory(
    time: float, positions: Sequence[float], goal: Goal | None = None
) -> SegmentTrajectory:
    """Return a trajectory that holds positions from `time` on.

    Args:
        time: Start of the trajectory [s].
        positions: Positions to hold [rad or m], shape (n,).
        goal: The goal that the trajectory belongs to; None if it belongs to none.
    """
    rest = [PosVelAccState([position], [0.0], [0.0]) for position in positions]
    return [
        [
            JointTrajectorySegment(
                QuinticSplineSegment(time, state, time, state), state, goal=goal
            )
        ]
        for state in rest
    ]


def stop_trajectory(
    time: float,
    duration: float,
    states: Sequence[tuple[float, float]],
    goal: Goal | None = None,
) -> SegmentTrajectory:
    """Return a trajectory that comes to rest within `duration`.

    The joints come to rest at the turning point of a motion that would reverse their
    velocities in twice the time, because that is the smoothest way to stop.

    Args:
        time: Start of the trajectory [s].
        duration: Time in which the joints come to rest [s], > 0.
        states: Position [rad or m] and velocity [rad/s or m/s] of every joint.
        goal: The goal that the trajectory belongs to; None if it belongs to none.
    """
    result: SegmentTrajectory = []
    for position, velocity in states:
        start = PosVelAccState([position], [velocity], [0.0])
        turned = PosVelAccState([position], [-velocity], [0.0])
        there_and_back = QuinticSplineSegment(
            time, start, time + 2.0 * duration, turned
        )
        rest = there_and_back.sample(time + duration)
        way = QuinticSplineSegment(time, start, time + duration, rest)
        segment = JointTrajectorySegment(way, rest, goal=goal)
        result.append([segment])
    return result
