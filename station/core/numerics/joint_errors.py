"""Differences between desired and measured values of joints, within their range.

Source: angles@1.9.13 include/angles/angles.h.
"""

import cython

from station.memory.doubles import Doubles, Storage, own_zeros

if cython.compiled:
    from cython.cimports.libc.math import fmod as _fmod
else:
    from math import fmod as _fmod

_HALF_TURN: float = 3.141592653589793
_TURN: float = 6.283185307179586
_LIMIT_ROUNDING: float = 1e-9
"""An angle that exceeds a limit by less than this counts as being on it [rad]."""

PLAIN = 0.0
"""A joint that slides, or a value that is not an angle: the error is the difference."""
CONTINUOUS = 1.0
"""A joint that takes the shorter of the two ways round."""
BOUNDED = 2.0
"""A joint that takes the shorter way that ends within its limits."""


def shortest_angular_distance(start: float, end: float) -> float:
    """Return the shortest turn that leads from `start` to `end`.

    Args:
        start: First angle [rad].
        end: Second angle [rad].

    Returns:
        The turn [rad], in (-pi, pi]; NaN when an angle is not finite.
    """
    difference = end - start
    # Python's fmod raises an error for infinity.
    if difference - difference != 0.0:
        return difference - difference
    turn: float = _fmod(_fmod(difference, _TURN) + _TURN, _TURN)
    return turn - _TURN if turn > _HALF_TURN else turn


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
    other = short - _TURN if short > 0.0 else short + _TURN
    lowest = lower - _LIMIT_ROUNDING
    highest = upper + _LIMIT_ROUNDING
    if lowest <= start + short and start + short <= highest:
        return short
    if lowest <= start + other and start + other <= highest:
        return other
    return short


def first_excess(errors: Storage, bounds: Storage) -> int:
    """Return the index of the first error beyond its bound in either direction, or -1.

    Args:
        errors: Errors, shape (n,); NaN exceeds no bound.
        bounds: Largest errors, >= 0, shape (n,); inf for none.
    """
    for k in range(len(errors)):
        error = errors[k]
        bound = bounds[k]
        if error > bound or -error > bound:
            return k
    return -1


class JointErrors:
    """Compares the desired with the measured values of n joints, in place.

    Args:
        desired: Desired values, shape (n,).
        measured: Measured values, shape (n,).
        errors: Receives the differences, shape (n,).
    """

    def __init__(self, desired: Doubles, measured: Doubles, errors: Storage) -> None:
        self.n = len(errors)
        self.desired = desired
        self.measured = measured
        self.errors = errors
        self.wrapping = own_zeros(self.n)
        self.lower = own_zeros(self.n)
        self.upper = own_zeros(self.n)
        self.bounds = own_zeros(self.n)

    def set_wrapping(self, k: int, wrapping: float, lower: float, upper: float) -> None:
        """Define whether joint `k` may take the other way round.

        Args:
            k: Index of the joint.
            wrapping: `PLAIN`, `CONTINUOUS` or `BOUNDED`.
            lower: Lower limit of a bounded joint [rad].
            upper: Upper limit of a bounded joint [rad].
        """
        self.wrapping[k] = wrapping
        self.lower[k] = lower
        self.upper[k] = upper

    def set_bound(self, k: int, bound: float) -> None:
        """Set the largest error of joint `k` for `exceeds`, >= 0; inf for none."""
        self.bounds[k] = bound

    def compare(self) -> None:
        """Write the differences."""
        desired, measured, errors = self.desired, self.measured, self.errors
        highest = _HALF_TURN
        lowest = -highest
        for k in range(self.n):
            error = desired[k] - measured[k]
            # The short way differs from the difference only beyond half a turn.
            if not lowest <= error <= highest:
                wrapping = self.wrapping[k]
                if wrapping == CONTINUOUS:
                    error = shortest_angular_distance(measured[k], desired[k])
                elif wrapping == BOUNDED:
                    error = shortest_angular_distance_with_limits(
                        measured[k], desired[k], self.lower[k], self.upper[k]
                    )
            errors[k] = error

    def exceeds(self) -> bool:
        """Return whether an error is larger than its bound, in either direction."""
        return first_excess(self.errors, self.bounds) >= 0
