"""Distances between angles, with and without joint limits.

Source: angles@1.9.13 include/angles/angles.h.
"""

from math import fmod, pi

_TURN = 2.0 * pi
_LIMIT_ROUNDING = 1e-9
"""An angle that exceeds a limit by less than this counts as being on it [rad]."""


def shortest_angular_distance(start: float, end: float) -> float:
    """Return the shortest turn that leads from `start` to `end`.

    Args:
        start: First angle [rad].
        end: Second angle [rad].

    Returns:
        The turn [rad], in (-pi, pi]; NaN when an angle is not finite.
    """
    difference = end - start
    if difference - difference != 0.0:  # math.fmod raises an error for infinity
        return float("nan")
    turn = fmod(fmod(difference, _TURN) + _TURN, _TURN)
    return turn - _TURN if turn > pi else turn


def shortest_angular_distance_with_limits(
    start: float, end: float, lower: float, upper: float
) -> float:
    """Return the shortest turn from `start` to `end` that ends within the limits.

    The limits may be more than a turn apart. If neither direction ends within the
    limits, the shorter turn is returned.

    Args:
        start: First angle [rad].
        end: Second angle, up to whole turns [rad].
        lower: Lower limit [rad].
        upper: Upper limit [rad], >= `lower`.

    Returns:
        The turn [rad], in (-2 pi, 2 pi); NaN when an angle is not finite.

    Source:
        angles@1.9.13 angles.h, shortest_angular_distance_with_large_limits; differs:
        the function does not return whether `start` is within the limits, and an `end`
        on a limit counts as within it despite rounding in the sum of `start` and turn.
    """
    short = shortest_angular_distance(start, end)
    long = short - _TURN if short > 0.0 else short + _TURN
    lowest, highest = lower - _LIMIT_ROUNDING, upper + _LIMIT_ROUNDING
    if lowest <= start + short <= highest or not lowest <= start + long <= highest:
        return short
    return long
