"""A segment of one joint's trajectory, and how to find and sample one.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_segment.h, trajectory_interface.h.
"""

from bisect import bisect_right
from dataclasses import dataclass, field, replace
from math import pi

from station.core.numerics.joint_errors import shortest_angular_distance
from station.core.ports.goal import Goal
from station.core.trajectory.quintic_spline_segment import (
    PosVelAccState,
    QuinticSplineSegment,
)
from station.core.trajectory.tolerances import JointTolerances

# Distances this near to half a turn [rad] have no shorter way but by rounding.
_HALF_TURN_ROUNDING = 1e-9


@dataclass(eq=False)
class JointTrajectorySegment:
    """A segment of one joint with the goal it belongs to and its tolerances.

    Args:
        spline: The path in time, of one dimension.
        end: The state at the end, kept for a bridge that may have to begin later.
        goal: The goal that the segment belongs to; None if it belongs to none.
        tolerances: Bounds of the error while it is executed; by default none.
        is_bridge: Whether the segment leads from an older trajectory to a new one.

    Attributes:
        start_time: Time at the start [s].
        end_time: Time at the end [s].
    """

    spline: QuinticSplineSegment
    end: PosVelAccState
    goal: Goal | None = None
    tolerances: JointTolerances = field(default_factory=JointTolerances)
    is_bridge: bool = False
    start_time: float = field(init=False)
    end_time: float = field(init=False)

    def __post_init__(self) -> None:
        self.start_time, self.end_time = self.spline.start_time, self.spline.end_time

    def with_goal(self, goal: Goal | None) -> "JointTrajectorySegment":
        """Return the same segment for another goal."""
        return replace(self, goal=goal)

    def starting_at(
        self, time: float, start: PosVelAccState
    ) -> "JointTrajectorySegment":
        """Return a segment with the same end that begins later, at `start`.

        Args:
            time: Time at the new start [s], <= `end_time`.
            start: State at the new start.
        """
        return replace(
            self, spline=QuinticSplineSegment(time, start, self.end_time, self.end)
        )


JointSegments = list[JointTrajectorySegment]
"""The segments of one joint in the order of time."""
SegmentTrajectory = list[JointSegments]
"""The segments of all joints of a controller, in the controller's order."""


def find_segment(segments: JointSegments, time: float) -> int | None:
    """Return the index of the segment that is active at a time.

    Args:
        segments: The segments.
        time: The time [s].

    Returns:
        The index, which after the end is that of the last segment; None before the
        first one.
    """
    index = bisect_right(segments, time, key=_start_time) - 1
    return index if index >= 0 else None


def sample_segments(segments: JointSegments, time: float) -> tuple[float, float, float]:
    """Return position, velocity and acceleration of one joint at a time.

    Before the first segment, the joint rests at its first position.

    Args:
        segments: At least one segment.
        time: The time [s].
    """
    index = find_segment(segments, time)
    return segments[0 if index is None else index].spline.sample_dimension(time)


def wraparound_offset(previous: float, following: float) -> float:
    """Return the whole turns to add so that a continuous joint takes the short way.

    Args:
        previous: Position of the joint [rad].
        following: Next position of the joint [rad].

    Returns:
        Offset for `following` [rad]. A distance of half a turn keeps its direction.
    """
    distance = shortest_angular_distance(previous, following)
    if abs(abs(distance) - pi) < _HALF_TURN_ROUNDING:
        distance = abs(distance) if following > previous else -abs(distance)
    return (previous + distance) - following


def _start_time(segment: JointTrajectorySegment) -> float:
    return segment.start_time
