"""A trajectory that passes waypoints without standing still at each of them."""

from collections.abc import Sequence
from itertools import pairwise

from station.core.trajectory.quintic_spline_segment import (
    PosVelAccState,
    QuinticSplineSegment,
)

_SAMPLES = 40
"""Number of points of a segment at which `peak_speeds` evaluates the speed."""


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
