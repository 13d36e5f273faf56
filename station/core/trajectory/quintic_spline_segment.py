"""Paths in time: polynomials of degree 1, 3 or 5, alone or through waypoints.

A part has one polynomial per dimension. Through waypoints, no joint stands still at
each of them.

Source: ros_controllers@678b92a joint_trajectory_controller/include/
trajectory_interface/quintic_spline_segment.h, pos_vel_acc_state.h.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from station.core.errors import InvalidTrajectoryError
from station.core.trajectory.splines import sample_splines
from station.memory.doubles import doubles, zeros

_PREFIX = "Quintic spline segment can't be constructed: "
_REMEDY = "Give both ends the same number of positions, and rates of the same size."
_SAMPLES = 40
"""Number of points of a segment at which `peak_speeds` evaluates the speed."""


@dataclass(frozen=True, slots=True)
class PosVelAccState:
    """Positions and, if known, their rates.

    Attributes:
        position: Positions [rad or m], shape (n,).
        velocity: Velocities [rad/s or m/s], shape (n,); empty if not specified.
        acceleration: Accelerations [rad/s^2 or m/s^2], shape (n,); empty if not
            specified.
        time_from_start: Time of the state from the trajectory's start [s].
    """

    position: list[float] = field(default_factory=list)
    velocity: list[float] = field(default_factory=list)
    acceleration: list[float] = field(default_factory=list)
    time_from_start: float = 0.0


class QuinticSplineSegment:
    """Leads from one state to another in a given time.

    The degree follows from the quantities that both ends specify: positions give a
    straight line, positions and velocities a cubic polynomial, and all three a quintic.

    Args:
        start_time: Time at the start state [s].
        start: State in which the segment begins.
        end_time: Time at the end state [s], >= `start_time`.
        end: State in which the segment ends.

    Attributes:
        start_time: Time at the start state [s].
        time_from_start: Time of the start state from the trajectory's start [s].
        size: The number of dimensions n.
        splines: The splines of all dimensions, see `sample_splines`, shape (8 n,).

    Raises:
        InvalidTrajectoryError: The end is before the start, or the sizes of the
            states do not match.

    Source:
        QuinticSplineSegment.init; differs: there is no empty segment.
    """

    def __init__(
        self,
        start_time: float,
        start: PosVelAccState,
        end_time: float,
        end: PosVelAccState,
    ) -> None:
        _check(start_time, start, end_time, end)
        self.start_time = start_time
        self.time_from_start = start.time_from_start
        self._duration = end_time - start_time
        self.size = len(start.position)
        self.splines = doubles(
            number
            for dimension in range(self.size)
            for number in (
                start_time,
                self._duration,
                *_coefficients(start, end, dimension, self._duration),
            )
        )

    @property
    def end_time(self) -> float:
        """The time at the end state [s]."""
        return self.start_time + self._duration

    def sample(self, time: float) -> PosVelAccState:
        """Return the state at a time.

        Before the start and after the end, the state is at rest at the nearer end.

        Args:
            time: The time [s].
        """
        states, size = self._states(time), self.size
        return PosVelAccState(
            states[:size], states[size : 2 * size], states[2 * size :]
        )

    def sample_dimension(
        self, time: float, dimension: int = 0
    ) -> tuple[float, float, float]:
        """Return position, velocity and acceleration of one dimension at `time` [s]."""
        position, velocity, acceleration = self._states(time)[dimension :: self.size]
        return position, velocity, acceleration

    def _states(self, time: float) -> list[float]:
        states = zeros(3 * self.size)
        sample_splines(self.splines, time, states)
        return [*states]


def _check(
    start_time: float, start: PosVelAccState, end_time: float, end: PosVelAccState
) -> None:
    size = len(start.position)
    both_velocities = bool(start.velocity) and bool(end.velocity)
    both_accelerations = bool(start.acceleration) and bool(end.acceleration)
    problem = None
    if end_time < start_time:
        problem = f"it ends at {end_time} s, before it starts at {start_time} s."
    elif not start.position or not end.position:
        problem = "an end has no positions."
    elif size != len(end.position):
        problem = f"its ends have {size} and {len(end.position)} positions."
    elif both_velocities and not size == len(start.velocity) == len(end.velocity):
        problem = (
            f"its ends have {len(start.velocity)} and {len(end.velocity)} velocities "
            f"for {size} positions."
        )
    elif both_accelerations and not (
        size == len(start.acceleration) == len(end.acceleration)
    ):
        problem = (
            f"its ends have {len(start.acceleration)} and {len(end.acceleration)} "
            f"accelerations for {size} positions."
        )
    if problem is not None:
        raise InvalidTrajectoryError(f"{_PREFIX}{problem}", remedy=_REMEDY)


def _coefficients(
    start: PosVelAccState, end: PosVelAccState, dimension: int, time: float
) -> tuple[float, float, float, float, float, float]:
    p0, p1 = start.position[dimension], end.position[dimension]
    if not start.velocity or not end.velocity:
        # A segment without duration is a jump: it has no slope, and no division by
        # zero.
        slope = 0.0 if time == 0.0 else (p1 - p0) / time
        return p0, slope, 0.0, 0.0, 0.0, 0.0
    v0, v1 = start.velocity[dimension], end.velocity[dimension]
    if not start.acceleration or not end.acceleration:
        return _cubic(p0, v0, p1, v1, time)
    ends = (p0, v0, start.acceleration[dimension])
    return _quintic(ends, (p1, v1, end.acceleration[dimension]), time)


def _cubic(
    p0: float, v0: float, p1: float, v1: float, time: float
) -> tuple[float, float, float, float, float, float]:
    if time == 0.0:
        return p0, v0, 0.0, 0.0, 0.0, 0.0
    t2 = time * time
    t3 = t2 * time
    c2 = (-3.0 * p0 + 3.0 * p1 - 2.0 * v0 * time - v1 * time) / t2
    c3 = (2.0 * p0 - 2.0 * p1 + v0 * time + v1 * time) / t3
    return p0, v0, c2, c3, 0.0, 0.0


def _quintic(
    start: tuple[float, float, float], end: tuple[float, float, float], time: float
) -> tuple[float, float, float, float, float, float]:
    p0, v0, a0 = start
    p1, v1, a1 = end
    if time == 0.0:
        return p0, v0, 0.5 * a0, 0.0, 0.0, 0.0
    t2 = time * time
    t3 = t2 * time
    t4 = t3 * time
    t5 = t4 * time
    c3 = (
        -20.0 * p0
        + 20.0 * p1
        - 3.0 * a0 * t2
        + a1 * t2
        - 12.0 * v0 * time
        - 8.0 * v1 * time
    ) / (2.0 * t3)
    c4 = (
        30.0 * p0
        - 30.0 * p1
        + 3.0 * a0 * t2
        - 2.0 * a1 * t2
        + 16.0 * v0 * time
        + 14.0 * v1 * time
    ) / (2.0 * t4)
    c5 = (
        -12.0 * p0 + 12.0 * p1 - a0 * t2 + a1 * t2 - 6.0 * v0 * time - 6.0 * v1 * time
    ) / (2.0 * t5)
    return p0, v0, 0.5 * a0, c3, c4, c5


def through_waypoints(
    start: Sequence[float], waypoints: Sequence[Sequence[float]], times: Sequence[float]
) -> list[PosVelAccState]:
    """Return the states at the waypoints, at rest at the start and at the last one.

    A quintic polynomial joins two states. A joint that continues in the same direction
    passes a waypoint with the harmonic mean of the mean speeds before and after it. A
    joint that turns round or waits at a waypoint is at rest there. So no joint moves
    beyond its waypoints.

    Args:
        start: Positions at the time 0 [rad or m], shape (n,).
        waypoints: Positions at the waypoints, shape (k, n).
        times: Times of the waypoints [s], shape (k,), positive and increasing.

    Source:
        Fritsch and Butland, A method for constructing local monotone piecewise cubic
        interpolants, SIAM J. Sci. Stat. Comput. 5 (1984); differs: the mean has no
        weights, and the polynomials are quintic without acceleration at their ends.
    """
    places = [start, *waypoints]
    knots = [0.0, *times]
    slopes = [
        [(b - a) / (end - begin) for a, b in zip(one, other, strict=True)]
        for (one, other), (begin, end) in zip(
            pairwise(places), pairwise(knots), strict=True
        )
    ]
    rest = [0.0] * len(start)
    inner = [
        [_passing_speed(a, b) for a, b in zip(before, after, strict=True)]
        for before, after in pairwise(slopes)
    ]
    return [
        PosVelAccState(list(place), speeds, list(rest), time)
        for place, speeds, time in zip(waypoints, [*inner, rest], times, strict=True)
    ]


def peak_speeds(
    start: Sequence[float], states: Sequence[PosVelAccState]
) -> list[list[float]]:
    """Return the largest speed of each joint on the way to each state.

    Args:
        start: Positions at the time 0, at rest [rad or m], shape (n,).
        states: The states of `through_waypoints`, k of them.

    Returns:
        Speeds [rad/s or m/s], shape (k, n).
    """
    rest = [0.0] * len(start)
    all_states = [PosVelAccState(list(start), rest, rest), *states]
    found = []
    for one, other in pairwise(all_states):
        begin, end = one.time_from_start, other.time_from_start
        segment = QuinticSplineSegment(begin, one, end, other)
        step = (end - begin) / _SAMPLES
        speeds = [segment.sample(begin + i * step).velocity for i in range(_SAMPLES)]
        found.append([max(map(abs, each)) for each in zip(*speeds, strict=True)])
    return found


def _passing_speed(before: float, after: float) -> float:
    return 0.0 if before * after <= 0.0 else 2.0 * before * after / (before + after)
