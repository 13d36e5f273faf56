"""Set-points that are poses: position [m], then quaternion w x y z."""

from collections.abc import Callable
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.forward_command_controller.command_timeout import (
    read_command_timeout,
)
from station.controllers.forward_command_controller.watched_set_point import (
    WatchedSetPoint,
)
from station.core.errors import InvalidCommandError
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement, SetPointPort

_REACH = 2.0
_LENGTH_TOLERANCE = 1e-3


class PosePort(SetPointPort):
    """Takes poses of 7 numbers; the quaternion must have unit length.

    Args:
        timeout: How long a pose is valid on the wall clock [s]; 0: for ever.
    """

    def __init__(self, timeout: float = 0.0) -> None:
        super().__init__(
            [
                *(SetPointElement(axis, "m", -_REACH, _REACH) for axis in "xyz"),
                *(SetPointElement(f"q{part}", "", -1.001, 1.001) for part in "wxyz"),
            ],
            timeout=timeout,
        )

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


class PoseTarget:
    """The pose in force: the newest, or where it has come to when that is not valid.

    Args:
        params: `command_timeout` and `command_timeout_action`, see `TimeoutAction`.
        subject: What is commanded, for messages.
        rest: Returns the pose to stay at, 7 numbers.

    Attributes:
        port: Where poses arrive.
    """

    def __init__(
        self, params: Parameters, subject: str, rest: Callable[[], list[float]]
    ) -> None:
        timeout, action = read_command_timeout(params)
        self.port = PosePort(timeout)
        self._watched = WatchedSetPoint(self.port, action, subject, rest)
        self._followed: list[float] = []

    def begin(self) -> None:
        """Stay; call it when the controller starts."""
        self._watched.begin()
        self._followed = self._watched.values

    def newest(self) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Return position (3,) and unit quaternion (4,) of a new pose, if there is one.

        Raises:
            CommandTimeoutError: The last one is not valid and the action is `stop`.
        """
        pose = self._watched.newest()
        if pose is self._followed:
            return None
        self._followed = pose
        rotation = np.array(pose[3:])
        return np.array(pose[:3]), rotation / np.linalg.norm(rotation)
