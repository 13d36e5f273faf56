"""Set-points that are poses: a position and a unit quaternion."""

from math import sqrt

from typing_extensions import override

from station.core.errors import InvalidCommandError
from station.core.ports.set_point import SetPointElement, SetPointPort

REACH = 2.0
"""Farthest coordinate that is taken [m]; no arm reaches it."""
NORM_TOLERANCE = 0.01
"""How far the length of a quaternion may be from 1."""


class PoseSetPointPort(SetPointPort):
    """Takes `x y z` [m] and `qx qy qz qw`; a quaternion and its negative are the same.

    Args:
        timeout: How long a set-point is valid [s].
        longest: Longest validity that a set-point may ask for [s].
    """

    def __init__(self, *, timeout: float, longest: float) -> None:
        bound = 1.0 + NORM_TOLERANCE
        super().__init__(
            [
                *(SetPointElement(axis, "m", -REACH, REACH) for axis in "xyz"),
                *(SetPointElement(f"q{part}", "", -bound, bound) for part in "xyzw"),
            ],
            timeout=timeout,
            longest=longest,
        )

    @override
    def check(
        self,
        values: list[float],
        timeout: float | None = None,
        rates: list[float] | None = None,
    ) -> None:
        """Refuse a malformed set-point, also one whose quaternion is not of length 1.

        Raises:
            InvalidCommandError: As `SetPointPort.check`; or the length is not 1.
        """
        super().check(values, timeout, rates)
        length = sqrt(sum(value * value for value in values[3:7]))
        if abs(length - 1.0) > NORM_TOLERANCE:
            raise InvalidCommandError(
                f"The quaternion of the command, {values[3:7]}, has length "
                f"{length:.4g}; it must be 1, at most {NORM_TOLERANCE} away.",
                remedy="Divide it by its length; the order is qx, qy, qz, qw.",
                details={"length": length},
            )
