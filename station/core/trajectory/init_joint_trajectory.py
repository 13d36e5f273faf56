"""Build the segments of a trajectory: as requested, at rest, or coming to rest.

A request contains points in time for named joints. Its trajectory is joined to the
executed trajectory.

Source: ros_controllers@678b92a joint_trajectory_controller/init_joint_trajectory.h,
joint_trajectory_segment.h, trajectory_interface.h, hold_trajectory_builder.h,
stop_trajectory_builder.h, joint_trajectory_msg_utils.h; trajectory_msgs/
JointTrajectory.msg.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import copysign, isfinite, pi

from station.core.errors import InvalidTrajectoryError, counted
from station.core.numerics.joint_errors import shortest_angular_distance
from station.core.ports.goal import Goal
from station.core.trajectory.quintic_spline_segment import (
    PosVelAccState,
    QuinticSplineSegment,
)
from station.core.trajectory.ros_time import to_nanoseconds, to_seconds
from station.core.trajectory.tolerances import JointTolerances


@dataclass(frozen=True, slots=True)
class JointTrajectoryPoint:
    """Desired state of the joints at one time; lists have the order of `joint_names`.

    Attributes:
        positions: Positions [rad or m].
        velocities: Velocities [rad/s or m/s]; empty if not specified.
        accelerations: Accelerations [rad/s^2 or m/s^2]; empty if not specified.
        time_from_start: Time from the start of the trajectory [s].
    """

    positions: Sequence[float]
    velocities: Sequence[float] = ()
    accelerations: Sequence[float] = ()
    time_from_start: float = 0.0


@dataclass(frozen=True, slots=True)
class JointTrajectory:
    """Points that the joints pass through.

    Attributes:
        joint_names: Names of the joints.
        points: The points in the order of time; without points, the joints stop and
            hold their positions.
        stamp: Station time at which the trajectory starts [s]; 0 means now.
    """

    joint_names: Sequence[str]
    points: Sequence[JointTrajectoryPoint]
    stamp: float = 0.0

    def start_nanoseconds(self, now: int) -> int:
        """Return the time at which the trajectory starts [ns].

        Args:
            now: The present time [ns].
        """
        stamp = to_nanoseconds(self.stamp)
        return now if stamp == 0 else stamp

    def is_due_at_once(self) -> bool:
        """Return whether the trajectory is a single point that is due now."""
        return self.stamp == 0.0 and self.points[-1].time_from_start == 0.0

    def first_not_later(self) -> int | None:
        """Return the index of the first point that is not later than the one before.

        None if there is none.
        """
        times = [to_nanoseconds(point.time_from_start) for point in self.points]
        for index, (before, time) in enumerate(pairwise(times), start=1):
            if time <= before:
                return index
        return None

    def last_point_before(self, now: int) -> int | None:
        """Return the index of the last point at or before `now` [ns]; None if none."""
        start = self.start_nanoseconds(now)
        found = None
        for index, point in enumerate(self.points):
            if start + to_nanoseconds(point.time_from_start) > now:
                break
            found = index
        return found

    def check_values(self) -> None:
        """Refuse points that do not fit the joints or are not finite.

        Raises:
            InvalidTrajectoryError: A point has the wrong number of positions,
                velocities or accelerations, or a number is not finite.
        """
        if not isfinite(self.stamp):
            raise InvalidTrajectoryError(
                f"The trajectory has the stamp {self.stamp}; it must be finite.",
                remedy="Give a finite time.",
            )
        for index, point in enumerate(self.points):
            self._check_point(index, point)

    def _check_point(self, index: int, point: JointTrajectoryPoint) -> None:
        size = len(self.joint_names)
        columns = {
            "positions": point.positions,
            "velocities": point.velocities,
            "accelerations": point.accelerations,
        }
        for what, values in columns.items():
            if len(values) != size and (values or what == "positions"):
                raise InvalidTrajectoryError(
                    f"Point {index} has {len(values)} {what} for "
                    f"{counted(size, 'joint')}.",
                    remedy=f"Give {size} {what}, in the order of joint_names.",
                    details={"point": index, "reason": "size"},
                )
            for name, value in zip(self.joint_names, values, strict=False):
                if not isfinite(value):
                    raise InvalidTrajectoryError(
                        f"Point {index} has {value} among its {what}, for '{name}'; "
                        "it must be finite.",
                        remedy="Give finite numbers.",
                        details={"point": index, "joint": name, "reason": "finite"},
                    )
        if not isfinite(point.time_from_start):
            raise InvalidTrajectoryError(
                f"Point {index} has the time_from_start {point.time_from_start}; it "
                "must be finite.",
                remedy="Give a finite time.",
                details={"point": index, "reason": "finite"},
            )


# Distances this near to half a turn [rad] have no shorter way but by rounding.
_HALF_TURN_ROUNDING = 1e-9


@dataclass(eq=False)
class JointTrajectorySegment:
    """A segment of one joint with the goal it belongs to and its tolerances.

    Args:
        spline: The path in time, of one dimension.
        end: The state at the end, kept in case the segment has to begin later.
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
        The index; that of the last segment after its end, None before the first
        segment.
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


_MOVING = 1e-6
"""Speed above which a joint moves [rad/s or m/s]; ends of splines are rounded."""


@dataclass(frozen=True, slots=True)
class TrajectoryOptions:
    """Options of turning a requested trajectory into an executable one.

    Attributes:
        current: The trajectory being executed; the result begins with the part of it
            before the requested start. None if the request is joined to nothing.
        joint_names: The joints of the controller in their order; None takes those of
            the request.
        angle_wraparound: Whether each of these joints is continuous; a continuous joint
            takes the short way from `current` to the request. None if no joint is.
        other_time_base: The present time in the time base of `current` and of the
            result [s]; None if that is the time base of the request.
        allow_partial_joints_goal: Whether the request may leave joints out.
        keeps_velocity: Whether a moving joint continues without a step of its velocity
            when the first point has no velocities; otherwise it moves on a line.
        goal: The goal of the new segments; None if they have none.
        tolerances: Bounds of the new segments by joint; None for no bounds.
    """

    current: SegmentTrajectory | None = None
    joint_names: Sequence[str] | None = None
    angle_wraparound: Sequence[bool] | None = None
    other_time_base: float | None = None
    allow_partial_joints_goal: bool = False
    keeps_velocity: bool = False
    goal: Goal | None = None
    tolerances: Mapping[str, JointTolerances] | None = None


@dataclass(frozen=True, slots=True)
class _Times:
    """Times in the time base of the result [ns].

    Attributes:
        now: The present time.
        start: The time at which the requested trajectory starts.
    """

    now: int
    start: int

    def of(self, point: JointTrajectoryPoint) -> float:
        """Return the time at which `point` is due [s]."""
        return to_seconds(self.start + to_nanoseconds(point.time_from_start))

    def bridge_end(self, point: JointTrajectoryPoint) -> float:
        """Return the time at which a bridge to `point` ends [s].

        The original adds seconds here, not nanoseconds, so the sum is rounded.
        """
        return to_seconds(self.start) + to_seconds(
            to_nanoseconds(point.time_from_start)
        )

    def takeover(self) -> float:
        """Return the time at which the new trajectory takes over [s]."""
        return to_seconds(max(self.start, self.now))


@dataclass(frozen=True, slots=True)
class _Label:
    """The goal and tolerances that all new segments of a joint share."""

    goal: Goal | None
    tolerances: JointTolerances

    def segment(
        self,
        start_time: float,
        start: PosVelAccState,
        end_time: float,
        end: PosVelAccState,
        *,
        is_bridge: bool = False,
    ) -> JointTrajectorySegment:
        """Return a segment between two states."""
        return JointTrajectorySegment(
            QuinticSplineSegment(start_time, start, end_time, end),
            end,
            goal=self.goal,
            tolerances=self.tolerances,
            is_bridge=is_bridge,
        )


def init_joint_trajectory(
    trajectory: JointTrajectory, now: float, options: TrajectoryOptions
) -> SegmentTrajectory:
    """Return the segments that lead along `trajectory` from `now` on.

    Points at or before `now` are dropped.

    Args:
        trajectory: The request.
        now: The present [s], in the time base of the request.
        options: The trajectory to join it to, and the goal and joints it is for.

    Returns:
        Segments for every joint; an empty list if there are too few points for a
        segment and no trajectory to join them to.

    Raises:
        InvalidTrajectoryError: The request is malformed, does not fit the joints, or
            lies in the past; `details["reason"]` says which.

    Source:
        initJointTrajectory; differs: sizes and numbers of all points are checked
        first, a joint may be named only once, and a start before the beginning of the
        other time base is allowed.
    """
    _check_points(trajectory)
    joint_names = list(options.joint_names or trajectory.joint_names)
    order = _check_joints(trajectory, joint_names, options)
    now_ns = to_nanoseconds(now)
    points = _points_after(trajectory, now_ns)
    start = trajectory.start_nanoseconds(now_ns)
    if options.other_time_base is None:
        times = _Times(now_ns, start)
    else:
        base = to_nanoseconds(options.other_time_base)
        times = _Times(base, base + (start - now_ns))
    result: SegmentTrajectory = [[] for _ in joint_names]
    if options.current:
        result = _take_over(options.current, to_seconds(times.now), options.goal)
    for column, joint in enumerate(order):
        states = [_state_of(point, column) for point in points]
        label = _label_of(joint_names[joint], options)
        segments: JointSegments = []
        if options.current:
            current = options.current[joint]
            start_state = _state_at(current, times.takeover())
            if options.angle_wraparound and options.angle_wraparound[joint]:
                states = _unwound(states, start_state)
            segments = _remaining(current, times)
            end_time = times.bridge_end(points[0])
            end = states[0]
            # As upstream, a bridge without a velocity at its end is a line, on which
            # the velocity of a moving joint would make a step.
            if options.keeps_velocity and abs(start_state.velocity[0]) > _MOVING:
                end = _with_velocity(states)
            segments.append(
                label.segment(
                    times.takeover(), start_state, end_time, end, is_bridge=True
                )
            )
        due = [times.of(point) for point in points]
        segments += [
            label.segment(due[i], states[i], due[i + 1], states[i + 1])
            for i in range(len(states) - 1)
        ]
        if segments:
            result[joint] = segments
    return result if any(result) else []


def check_joint_names(
    names: Sequence[str], expected: Sequence[str], *, allow_partial_joints_goal: bool
) -> list[int]:
    """Return the index among `expected` of every joint of a request.

    Args:
        names: The joints of the request.
        expected: The joints of the controller.
        allow_partial_joints_goal: Whether the request may leave joints out.

    Raises:
        InvalidTrajectoryError: The joints are not the expected ones.
    """
    known = bool(names) and set(names) <= set(expected)
    complete = allow_partial_joints_goal or len(names) == len(expected)
    if not known or not complete or len(set(names)) != len(names):
        raise InvalidTrajectoryError(
            f"The trajectory names the joints {', '.join(names) or 'none'}; expected "
            f"are {', '.join(expected)}.",
            remedy="Name "
            + ("some" if allow_partial_joints_goal else "all")
            + " of these joints, each once, in any order.",
            details={"reason": "joints", "expected": list(expected)},
        )
    return [expected.index(name) for name in names]


def _check_points(trajectory: JointTrajectory) -> None:
    trajectory.check_values()
    if not trajectory.points:
        raise InvalidTrajectoryError(
            "The trajectory has no points.",
            remedy="Give at least one point.",
            details={"reason": "empty"},
        )
    index = trajectory.first_not_later()
    if index is not None:
        before, late = (
            trajectory.points[i].time_from_start for i in (index - 1, index)
        )
        raise InvalidTrajectoryError(
            f"Point {index} is due {late:.9g} s after the start, not later than point "
            f"{index - 1}, which is due after {before:.9g} s.",
            remedy="Give every point a later time_from_start than the one before.",
            details={"reason": "order", "point": index},
        )


def _check_joints(
    trajectory: JointTrajectory, joint_names: list[str], options: TrajectoryOptions
) -> list[int]:
    """Return the index in `joint_names` of every joint of the request.

    Raises:
        InvalidTrajectoryError: The joints are not the expected ones.
    """
    wraps = options.angle_wraparound
    if wraps and len(wraps) != len(joint_names):
        raise InvalidTrajectoryError(
            f"angle_wraparound has {len(wraps)} values for {len(joint_names)} joints.",
            remedy="Give one value for every joint.",
            details={"reason": "wraparound"},
        )
    return check_joint_names(
        trajectory.joint_names,
        joint_names,
        allow_partial_joints_goal=options.allow_partial_joints_goal,
    )


def _points_after(trajectory: JointTrajectory, now: int) -> list[JointTrajectoryPoint]:
    last = trajectory.last_point_before(now)
    if last is None:
        return list(trajectory.points)
    if last + 1 < len(trajectory.points):
        return list(trajectory.points[last + 1 :])
    start = trajectory.start_nanoseconds(now)
    end = start + to_nanoseconds(trajectory.points[-1].time_from_start)
    late = to_seconds(now - end)
    raise InvalidTrajectoryError(
        f"All {len(trajectory.points)} points of the trajectory are in the past, the "
        f"last one by {late:.6f} s.",
        remedy="Give points after the present time, or leave the stamp out.",
        details={"reason": "past", "late_s": late},
    )


def _take_over(
    current: SegmentTrajectory, now: float, goal: Goal | None
) -> SegmentTrajectory:
    """Return the current segments, those from now on under the new goal."""
    result: SegmentTrajectory = []
    for segments in current:
        active = find_segment(segments, now)
        first = len(segments) if active is None else active
        result.append(
            segments[:first] + [each.with_goal(goal) for each in segments[first:]]
        )
    return result


def _state_of(point: JointTrajectoryPoint, column: int) -> PosVelAccState:
    return PosVelAccState(
        [point.positions[column]],
        [point.velocities[column]] if point.velocities else [],
        [point.accelerations[column]] if point.accelerations else [],
        point.time_from_start,
    )


def _label_of(name: str, options: TrajectoryOptions) -> _Label:
    bounds = JointTolerances()
    if options.goal is not None and options.tolerances is not None:
        bounds = options.tolerances.get(name, bounds)
    return _Label(options.goal, bounds)


def _state_at(segments: JointSegments, time: float) -> PosVelAccState:
    position, velocity, acceleration = sample_segments(segments, time)
    return PosVelAccState([position], [velocity], [acceleration])


def _unwound(
    states: list[PosVelAccState], start: PosVelAccState
) -> list[PosVelAccState]:
    """Return the states with whole turns added, so that the first is near `start`."""
    offset = wraparound_offset(start.position[0], states[0].position[0])
    return [
        PosVelAccState(
            [state.position[0] + offset],
            state.velocity,
            state.acceleration,
            state.time_from_start,
        )
        for state in states
    ]


def _with_velocity(states: list[PosVelAccState]) -> PosVelAccState:
    """Return the first state with a velocity: its own, or that of the line after it."""
    first, *others = states
    if first.velocity:
        return first
    velocity = 0.0
    if others:
        duration = others[0].time_from_start - first.time_from_start
        velocity = (others[0].position[0] - first.position[0]) / duration
    return PosVelAccState(first.position, [velocity], [], first.time_from_start)


def _remaining(current: JointSegments, times: _Times) -> JointSegments:
    """Return the current segments that are still executed before the takeover.

    Raises:
        InvalidTrajectoryError: The segments do not cover the time until the takeover.
    """
    now = to_seconds(times.now)
    first, last = find_segment(current, now), find_segment(current, times.takeover())
    if first is None or last is None:
        raise InvalidTrajectoryError(
            f"The trajectory being executed does not cover the time {now} s.",
            remedy="Start the controller again.",
            details={"reason": "gap"},
        )
    return current[first : last + 1]


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


def braking_trajectory(
    time: float,
    decelerations: Sequence[float],
    states: Sequence[tuple[float, float]],
    goal: Goal | None = None,
) -> SegmentTrajectory:
    """Return a trajectory in which each joint comes to rest with its own deceleration.

    Args:
        time: Start of the trajectory [s].
        decelerations: Deceleration of every joint [rad/s^2 or m/s^2], > 0.
        states: Position [rad or m] and velocity [rad/s or m/s] of every joint.
        goal: The goal that the trajectory belongs to; None if it belongs to none.

    Source:
        ros2_controllers@6.x joint_trajectory_controller, decelerate_to_hold_position.
    """
    result: SegmentTrajectory = []
    for (position, velocity), deceleration in zip(states, decelerations, strict=True):
        duration = abs(velocity) / deceleration
        braking = [copysign(deceleration, -velocity) if velocity else 0.0]
        rest = [position + velocity * duration / 2.0]
        way = QuinticSplineSegment(
            time,
            PosVelAccState([position], [velocity], braking),
            time + duration,
            PosVelAccState(rest, [0.0], braking),
        )
        end = PosVelAccState(rest, [0.0], [0.0])
        result.append([JointTrajectorySegment(way, end, goal=goal)])
    return result
