"""Turn requested trajectories into ones that the joints can follow, or refuse them.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller_impl.h, updateTrajectoryCommand; differs: positions beyond a
joint's limits are refused, and segments that are too fast or lead beyond the limits.
"""

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import comb, inf, isfinite, nan, pi
from operator import mul

from station.controllers.joint_trajectory_controller.execution import (
    Request,
    TrajectoryExecution,
)
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.errors import InvalidTrajectoryError
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import Goal
from station.core.ports.set_point import RANGE_TOLERANCE
from station.core.trajectory import (
    JointTolerances,
    JointTrajectory,
    JointTrajectorySegment,
    PosVelAccState,
    SegmentTrajectory,
    TrajectoryOptions,
    check_joint_names,
    find_segment,
    hold_trajectory,
    init_joint_trajectory,
    sample_segments,
)
from station.core.trajectory.ros_time import to_nanoseconds, to_seconds

MAX_DURATION = 86_400.0
"""Latest end of a trajectory from now, and longest goal time tolerance [s]: a day."""
_FLOAT_EPSILON = 2.0**-23
_PEAK_RATIO = 1.1
"""Allowed speed between two points as a multiple of the limit: planners bound the speed
at the points only."""
_ROUNDING = 1e-6
"""Relative excess that rounding may cause."""
_BEZIER = {
    degree: [
        [comb(j, k) / comb(degree, k) for k in range(j + 1)] for j in range(degree + 1)
    ]
    for degree in (4, 5)
}
"""Weights of the powers of time in a polynomial's control points, by its degree."""
_HALF_TURN = pi * (1.0 + 1e-6)
"""Largest angle without whole turns, with the rounding of written numbers [rad]."""
_STANDS = 1e-6
"""Distance up to which a requested position counts as the measured one [rad or m]."""


@dataclass(frozen=True, slots=True)
class _Present:
    """The state from which a new trajectory continues.

    Attributes:
        time: Station time of the last cycle [s].
        period: Its time since the cycle before [s].
        uptime: Trajectory time of the cycle [ns].
        trajectory: Trajectory that is executed after all queued requests.
        places: Commanded and measured position of each joint [rad or m], by name.
        rests: Whether no joint is to move and no request waits.
    """

    time: float
    period: float
    uptime: int
    trajectory: SegmentTrajectory
    places: Mapping[str, tuple[float, float]]
    rests: bool


class TrajectoryPlanner:
    """Plans requests in the threads that make them; the next cycle takes them up.

    Args:
        execution: Carries the plans out.
        joints: The joints.
        allow_partial_joints_goal: Whether a trajectory may leave joints out.
        may_end_moving: Whether the last point may have velocities.

    Attributes:
        execution: As given.
    """

    def __init__(
        self,
        execution: TrajectoryExecution,
        joints: list[JointDescription],
        *,
        allow_partial_joints_goal: bool = False,
        may_end_moving: bool = True,
    ) -> None:
        self.execution = execution
        self._joints = joints
        self._names = [joint.name for joint in joints]
        self._wraps = [joint.type is JointType.CONTINUOUS for joint in joints]
        self._allow_partial = allow_partial_joints_goal
        self._may_end_moving = may_end_moving
        self._planning = threading.Lock()

    def plan(
        self,
        request: JointTrajectory,
        goal: Goal | None = None,
        tolerances: Mapping[str, JointTolerances] | None = None,
        ticket: CommandTicket | None = None,
    ) -> None:
        """Plan a request and let the next cycle take it up.

        Args:
            request: The requested trajectory; without points: stop and hold.
            goal: The goal that ends with the trajectory. The request of a goal names
                the joints even when it has no points.
            tolerances: Bounds of the errors by joint, used with a goal.
            ticket: Notes the cycle that takes the request.

        Raises:
            InvalidTrajectoryError: The request cannot be followed; nothing changed.
        """
        with self._planning:
            # Replaced trajectories are freed here, where time does not matter.
            self.execution.retired.clear()
            planned = None
            if request.points:
                planned = self._planned(request, goal, tolerances, ticket)
            elif goal is not None:
                check_joint_names(
                    request.joint_names,
                    self._names,
                    allow_partial_joints_goal=self._allow_partial,
                )
            made = Request(planned, goal, ticket)
            if ticket is None:
                self.execution.requests.append(made)
            else:
                ticket.hand_over(lambda: self.execution.requests.append(made))

    def query(self, time: float) -> PosVelAccState:
        """Return the desired state at a past or future time. Any thread.

        The present speed scaling is assumed for all times.

        Args:
            time: Station time [s].

        Raises:
            InvalidTrajectoryError: `time` is before the trajectory being executed.
        """
        (present, _, uptime), trajectory = (
            self.execution.moment,
            self.execution.trajectory,
        )
        factor = self.execution.speed.factor
        when = to_seconds(uptime) + factor * (time - present)
        states = []
        for segments in trajectory:
            if find_segment(segments, when) is None:
                raise InvalidTrajectoryError(
                    f"The time {time} s is before the trajectory being executed.",
                    remedy=f"Ask for a later time; now it is {present} s.",
                )
            states.append(sample_segments(segments, when))
        return PosVelAccState(
            [state[0] for state in states],
            [factor * state[1] for state in states],
            [factor * factor * state[2] for state in states],
        )

    def resting_place(self) -> list[float]:
        """Return the positions at which the joints are held [rad or m]. Any thread.

        Raises:
            InvalidTrajectoryError: The joints move.
        """
        present = self._present()
        if not present.rests:
            raise InvalidTrajectoryError(
                "The joints move; a sequence of primitives begins where they rest.",
                remedy="Wait until they rest, or cancel the goal.",
                details={"reason": "moving"},
            )
        return [present.places[name][0] for name in self._names]

    def _planned(
        self,
        request: JointTrajectory,
        goal: Goal | None,
        tolerances: Mapping[str, JointTolerances] | None,
        ticket: CommandTicket | None,
    ) -> SegmentTrajectory | None:
        """Return the trajectory of a request; None to hold, if all joints are there.

        Raises:
            InvalidTrajectoryError: The request cannot be followed.
        """
        present = self._present()
        if ticket is not None:
            ticket.planned_at = present.time
        check_times(request, present.time)
        if not self._may_end_moving:
            check_end(request)
        request, tolerances = self._stays(request, tolerances, present)
        passed = to_nanoseconds(present.period * self.execution.speed.factor)
        following = present.uptime + passed
        options = TrajectoryOptions(
            current=present.trajectory,
            joint_names=self._names,
            angle_wraparound=self._wraps_of(request),
            other_time_base=to_seconds(following),
            allow_partial_joints_goal=self._allow_partial,
            keeps_velocity=True,
            goal=goal,
            tolerances=tolerances,
        )
        now = present.time + present.period
        try:
            return self._checked(request, now, options, present)
        except InvalidTrajectoryError as error:
            if error.details.get("reason") == "past" and request.is_due_at_once():
                self._check_arrived(request, tolerances, present)
                return None
        # Where a moving joint has no room to turn, the line of the original is left.
        options = replace(options, keeps_velocity=False)
        return self._checked(request, now, options, present)

    def _present(self) -> _Present:
        """Return the state from which a new trajectory continues, all of one cycle.

        A re-run of a recording plans between the same two cycles, so the trajectory
        continues from the same state there.
        """
        execution = self.execution
        while True:
            moment = execution.moment
            time, period, uptime = moment
            latest, places = self._latest_trajectory(), self._places()
            rests = (
                not any(self.execution.tracking.velocities)
                and not self.execution.requests
            )
            if self.execution.moment is moment:
                return _Present(time, period, uptime, latest, places, rests)

    def _places(self) -> dict[str, tuple[float, float]]:
        """Return the commanded and measured positions by joint name [rad or m]."""
        measured = self.execution.tracking.memory.positions
        places = zip(self.execution.tracking.positions, measured, strict=True)
        return dict(zip(self._names, places, strict=True))

    def _latest_trajectory(self) -> SegmentTrajectory:
        """Return the trajectory that is executed after all queued requests."""
        try:
            latest = self.execution.requests[-1].trajectory
        except IndexError:
            return self.execution.trajectory
        if latest is None:  # After a stop nothing of the present trajectory goes on.
            return hold_trajectory(
                self.execution.sampled, [*self.execution.tracking.positions]
            )
        return latest

    def _checked(
        self,
        request: JointTrajectory,
        now: float,
        options: TrajectoryOptions,
        present: _Present,
    ) -> SegmentTrajectory:
        planned = init_joint_trajectory(request, now, options)
        check_positions(request, self._joints, present.places)
        self._check_segments(planned, options.current or [])
        return planned

    def _wraps_of(self, request: JointTrajectory) -> list[bool]:
        """Return the joints that take the short way to a request's first point.

        Planners send an angle within half a turn. A position beyond half a turn counts
        whole turns: without them, success would be reported for another motion than the
        requested one.
        """
        first = dict(
            zip(request.joint_names, request.points[0].positions, strict=False)
        )
        return [
            wraps and abs(first.get(name, 0.0)) <= _HALF_TURN
            for name, wraps in zip(self._names, self._wraps, strict=True)
        ]

    def _stays(
        self,
        request: JointTrajectory,
        tolerances: Mapping[str, JointTolerances] | None,
        present: _Present,
    ) -> tuple[JointTrajectory, Mapping[str, JointTolerances] | None]:
        """Replace a request for the measured positions by one for the held positions.

        A loaded joint stands below where it is commanded to be. If it were commanded to
        the place where it stands, it would sink instead of staying there.
        """
        places, names = present.places, request.joint_names
        point = request.points[0]
        if (
            len(request.points) > 1
            or len(point.positions) != len(names)
            or any((*point.velocities, *point.accelerations))
            or not present.rests
        ):
            return request, tolerances
        offsets: dict[str, float] = {}
        for name, wanted in zip(names, point.positions, strict=True):
            commanded, measured = places.get(name, (inf, inf))
            if abs(wanted - measured) > _STANDS:
                return request, tolerances
            offsets[name] = abs(commanded - wanted)
        held = replace(point, positions=[places[name][0] for name in names])
        widened = {
            name: each.with_wider_goal(offsets.get(name, 0.0))
            for name, each in (tolerances or {}).items()
        }
        return replace(request, points=[held]), widened

    def _check_arrived(
        self,
        request: JointTrajectory,
        tolerances: Mapping[str, JointTolerances] | None,
        present: _Present,
    ) -> None:
        """Refuse a single point that is due at once where the joints are not.

        Raises:
            InvalidTrajectoryError: A joint is somewhere else.
        """
        places = present.places
        for name, wanted in zip(
            request.joint_names, request.points[0].positions, strict=True
        ):
            bounds = (tolerances or {}).get(name, JointTolerances())
            allowed = max(bounds.goal.position, RANGE_TOLERANCE)
            distance = min((wanted - place for place in places[name]), key=abs)
            if abs(distance) > allowed:
                raise InvalidTrajectoryError(
                    f"Joint '{name}' is {abs(distance):.6g} away from the only point "
                    "of the trajectory, which is due at once.",
                    remedy="Give the point a time_from_start above 0 s.",
                    details={"reason": "past", "joint": name, "distance": distance},
                )

    def _check_segments(
        self, planned: SegmentTrajectory, current: SegmentTrajectory
    ) -> None:
        """Refuse new segments that are too fast, or lead beyond the limits.

        A trajectory that starts far from where the joints are has such segments.

        Raises:
            InvalidTrajectoryError: A segment is too fast, or leads beyond the limits.
        """
        for joint, segments, before in zip(self._joints, planned, current, strict=True):
            # Segments of the present trajectory have been checked before.
            known = {id(segment.spline) for segment in before}
            for segment in segments:
                if id(segment.spline) not in known:
                    check_segment(joint, segment)


def check_times(request: JointTrajectory, now: float) -> None:
    """Refuse times before the start, and points due later than in `MAX_DURATION`.

    Times that long come from a wrong unit, such as nanoseconds.

    Args:
        request: The trajectory.
        now: Station time [s].

    Raises:
        InvalidTrajectoryError: A point has such a time.
    """
    ahead = request.stamp - now if request.stamp else 0.0
    for index, point in enumerate(request.points):
        time = point.time_from_start
        if time < 0.0:
            raise InvalidTrajectoryError(
                f"Point {index} has the time_from_start {time:.9g} s, which is before "
                "the start.",
                remedy="Give every point a time_from_start of 0 s or more.",
                details={"point": index, "reason": "past"},
            )
        due = ahead + time
        if due > MAX_DURATION:
            raise InvalidTrajectoryError(
                f"Point {index} is due in {due:.6g} s; allowed are {MAX_DURATION:g} s.",
                remedy="Give times in seconds, not in nanoseconds.",
                details={"point": index, "reason": "duration", "due": due},
            )


def check_end(request: JointTrajectory) -> None:
    """Refuse velocities of the last point.

    Args:
        request: The trajectory, with points.

    Raises:
        InvalidTrajectoryError: The last point has such a velocity.

    Source:
        ros2_controllers@6.x joint_trajectory_controller.cpp, validate_trajectory_msg.
    """
    # Names of the wrong number are refused elsewhere.
    velocities = zip(request.joint_names, request.points[-1].velocities, strict=False)
    for name, velocity in velocities:
        if abs(velocity) > _FLOAT_EPSILON:
            raise InvalidTrajectoryError(
                f"The trajectory ends with a velocity of {velocity:.6g} of '{name}'; "
                "it must be 0.",
                remedy="Let the joints come to rest, or set "
                "allow_nonzero_velocity_at_trajectory_end.",
                details={"joint": name, "quantity": "velocity", "reason": "end"},
            )


def check_positions(
    request: JointTrajectory,
    joints: Sequence[JointDescription],
    here: Mapping[str, Sequence[float]],
) -> None:
    """Refuse positions beyond the limits of a joint.

    A joint may be beyond a limit, e.g. where it rests on its stop. From there it may
    move back, but no further out.

    Args:
        request: The trajectory; every point has one position for each of its joints.
        joints: The joints of the controller.
        here: Commanded and measured position of each joint [rad or m], by name.

    Raises:
        InvalidTrajectoryError: A position is beyond the joint's limits.
    """
    known = {joint.name: joint for joint in joints}
    for column, name in enumerate(request.joint_names):
        joint = known[name]
        lowest, highest = joint.lower - RANGE_TOLERANCE, joint.upper + RANGE_TOLERANCE
        lower, upper = min(lowest, *here[name]), max(highest, *here[name])
        for index, point in enumerate(request.points):
            position = point.positions[column]
            if not lower <= position <= upper:
                raise InvalidTrajectoryError(
                    f"Point {index} has the position {position} for '{name}'; "
                    f"allowed is {joint.lower} to {joint.upper}.",
                    remedy="Give positions within the limits of the joint.",
                    details={"point": index, "joint": name, "reason": "limits"},
                )
            lower = min(lowest, max(lower, position))
            upper = max(highest, min(upper, position))


def check_segment(joint: JointDescription, segment: JointTrajectorySegment) -> None:
    """Refuse a segment that is too fast for its joint, or leads beyond its limits.

    Both ends of a segment may be allowed while the spline between them is not: it
    swings out when velocities and time do not fit the distance.

    Args:
        joint: The joint; unlimited when its description has no limits.
        segment: The motion from one point to the next.

    Raises:
        InvalidTrajectoryError: The segment is not allowed; `details["reason"]` is
            `pace` or `limits`.
    """
    _, duration, *powers = segment.spline.splines
    start, end = powers[0], segment.end.position[0]
    distance = end - start
    unit = "m" if joint.is_linear() else "rad"
    # `not <=` instead of `>`: NaN compares false, and is refused like this.
    if not abs(distance) <= joint.velocity * duration * (1.0 + _ROUNDING):
        raise InvalidTrajectoryError(
            f"Joint '{joint.name}' would have to move {distance:.6g} {unit} in "
            f"{duration:.6g} s on its way to {end:.6g} {unit}; its limit is "
            f"{joint.velocity:.6g} {unit}/s.",
            remedy="Start the trajectory where the joints are, or give it more time.",
            details={
                "reason": "pace",
                "joint": joint.name,
                "distance": distance,
                "duration": duration,
                "velocity_limit": joint.velocity,
            },
        )
    _check_speed(joint, powers, duration, end)
    _check_range(joint, powers, duration, end)


def _check_speed(
    joint: JointDescription, powers: Sequence[float], duration: float, end: float
) -> None:
    unit = "m" if joint.is_linear() else "rad"
    rates = [power * value for power, value in enumerate(powers)][1:]
    last = sum(rate * duration**power for power, rate in enumerate(rates))
    limit = joint.velocity * (1.0 + _ROUNDING)
    peak = _PEAK_RATIO * joint.velocity
    slowest, fastest = _extremes(rates, duration, -peak, peak)
    velocity = fastest if fastest > -slowest else slowest
    if abs(last) <= limit and -peak <= slowest and fastest <= peak:
        return
    if not abs(last) <= limit:
        velocity = last
    raise InvalidTrajectoryError(
        f"Joint '{joint.name}' would move with {velocity:.6g} {unit}/s on its "
        f"way to {end:.6g} {unit}; its limit is {joint.velocity:.6g} {unit}/s.",
        remedy="Correct the velocities and accelerations of the points, or give the "
        "motion more time.",
        details={
            "reason": "pace",
            "joint": joint.name,
            "velocity": velocity,
            "velocity_limit": joint.velocity,
        },
    )


def _check_range(
    joint: JointDescription, powers: Sequence[float], duration: float, end: float
) -> None:
    unit = "m" if joint.is_linear() else "rad"
    lower = min(joint.lower, powers[0], end) - RANGE_TOLERANCE
    upper = max(joint.upper, powers[0], end) + RANGE_TOLERANCE
    lowest, highest = _extremes(powers, duration, lower, upper)
    if lower <= lowest and highest <= upper:
        return
    position = highest if highest > upper else lowest
    raise InvalidTrajectoryError(
        f"Joint '{joint.name}' would swing out to {position:.6g} {unit} on its way to "
        f"{end:.6g} {unit}; allowed is {joint.lower} to {joint.upper}.",
        remedy="Give points whose velocities fit the distance and the time between "
        "them, or more points.",
        details={"reason": "limits", "joint": joint.name, "position": position},
    )


def _extremes(
    powers: Sequence[float], duration: float, low: float, high: float
) -> tuple[float, float]:
    """Return the least and the greatest value of a polynomial, or `low` and `high`.

    NaN for a polynomial whose values are not finite.

    Args:
        powers: Coefficients of the powers of time, the constant first.
        duration: Time at which the polynomial ends [s]; it begins at 0.
        low: Returned when no value is less.
        high: Returned when no value is greater.
    """
    scaled, factor = [], 1.0
    for value in powers:
        scaled.append(value * factor)
        factor *= duration
    # The control points of its Bézier curve, whose hull holds the whole polynomial.
    points = [sum(map(mul, row, scaled)) for row in _BEZIER[len(powers) - 1]]
    if not isfinite(sum(points)):
        return nan, nan
    slack = _ROUNDING * max(map(abs, points))
    return _extremes_of_curve(points, low, high, slack)


def _extremes_of_curve(
    points: list[float], low: float, high: float, slack: float
) -> tuple[float, float]:
    low, high = min(low, points[0], points[-1]), max(high, points[0], points[-1])
    # Without any slack, rounding would have every half of a flat curve halved again.
    if low - slack <= min(points) and max(points) <= high + slack:
        return low, high
    first, second = [points[0]], [points[-1]]
    while len(points) > 1:  # de Casteljau's algorithm halves the curve
        points = [0.5 * (a + b) for a, b in pairwise(points)]
        first.append(points[0])
        second.append(points[-1])
    low, high = _extremes_of_curve(first, low, high, slack)
    return _extremes_of_curve(second[::-1], low, high, slack)
