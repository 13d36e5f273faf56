"""Set-points that are poses: a position and a unit quaternion."""

from math import sqrt

from typing_extensions import override

from station.core.errors import InvalidCommandError
from station.core.ports.set_point import SetPointElement, SetPointPort

REACH = 2.0
"""Largest coordinate of a position [m]; no arm reaches farther."""


class PosePort(SetPointPort):
    """Takes `x y z` [m], then the four parts of a unit quaternion.

    A quaternion and its negative are the same orientation.

    Args:
        order: Order of the parts of the quaternion, `xyzw` or `wxyz`.
        tolerance: Largest difference of the quaternion's length from 1.
        timeout: How long a set-point is valid [s]; 0 for ever.
        longest: Longest validity that a set-point may ask for [s].
    """

    def __init__(
        self, order: str, *, tolerance: float, timeout: float, longest: float
    ) -> None:
        bound = 1.0 + tolerance
        super().__init__(
            [
                *(SetPointElement(axis, "m", -REACH, REACH) for axis in "xyz"),
                *(SetPointElement(f"q{part}", "", -bound, bound) for part in order),
            ],
            timeout=timeout,
            longest=longest,
        )
        self._tolerance = tolerance

    @override
    def check_values(self, values: list[float]) -> None:
        """Refuse a malformed set-point, and a quaternion whose length is not 1.

        Args:
            values: The pose, shape (7,).

        Raises:
            InvalidCommandError: As in `SetPointPort.check`, or the length is not 1.
        """
        super().check_values(values)
        length = sqrt(sum(value * value for value in values[3:7]))
        if abs(length - 1.0) > self._tolerance:
            order = ", ".join(element.name for element in self.elements[3:])
            raise InvalidCommandError(
                f"The quaternion of the command, {values[3:7]}, has the length "
                f"{length:.4g}; allowed is 1, at most {self._tolerance} away.",
                remedy=f"Divide the quaternion by its length; the order is {order}.",
                details={"length": length},
            )
