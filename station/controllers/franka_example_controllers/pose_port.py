"""Set-points that are poses: position [m], then quaternion w x y z."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.core.errors import InvalidCommandError
from station.core.set_point import SetPointElement, SetPointPort

_REACH = 2.0
_LENGTH_TOLERANCE = 1e-3


class PosePort(SetPointPort):
    """Takes poses of 7 numbers; the quaternion must have unit length."""

    def __init__(self) -> None:
        super().__init__([
            *(SetPointElement(axis, "m", -_REACH, _REACH) for axis in "xyz"),
            *(SetPointElement(f"q{part}", "", -1.001, 1.001) for part in "wxyz"),
        ])

    @override
    def check(
        self,
        values: list[float],
        timeout: float | None = None,
        rates: list[float] | None = None,
    ) -> None:
        """Refuse a malformed pose.

        Args:
            values: The pose, shape (7,).
            timeout: As in `SetPointPort.check`.
            rates: As in `SetPointPort.check`.

        Raises:
            InvalidCommandError: Not 7 finite numbers in their ranges, or the quaternion
                has not the length 1.
        """
        super().check(values, timeout, rates)
        length = sqrt(sum(value * value for value in values[3:]))
        if abs(length - 1.0) > _LENGTH_TOLERANCE:
            raise InvalidCommandError(
                f"The quaternion of the command has the length {length:.4f}; allowed "
                f"is 1, at most {_LENGTH_TOLERANCE} away.",
                remedy="Send w x y z of unit length.",
                details={"length": length},
            )

    def take_pose(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Return position (3,) and unit quaternion (4,) of the newest pose, if any."""
        command = self.take()
        if command is None:
            return None
        rotation = np.array(command[3:])
        return np.array(command[:3]), rotation / np.linalg.norm(rotation)
