"""The pose in force: a set-point of position [m] and quaternion w x y z."""

from collections.abc import Callable
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.franka_arm.cartesian_spring import (
    CartesianSpring,
    SpringUpdate,
)
from station.core.errors import InvalidCommandError
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
)
from station.core.toolbox.publish_timer import PublishTimer

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


_LENGTH_TOLERANCE = 1e-3


class PoseTarget:
    """The target pose: the newest set-point, or rest once that has expired.

    Args:
        params: `command_timeout` and `command_timeout_action`, see `TimeoutAction`.
        subject: Name of the commanded thing, for messages.
        rest: Returns the pose at which to rest, 7 numbers.

    Attributes:
        port: Receives the poses.
    """

    def __init__(
        self, params: Parameters, subject: str, rest: Callable[[], list[float]]
    ) -> None:
        timeout, action = read_command_timeout(params)
        self.port = PosePort(
            "wxyz", tolerance=_LENGTH_TOLERANCE, timeout=timeout, longest=inf
        )
        self._active = ActiveSetPoint(self.port, action, subject, rest)
        self._followed: list[float] = []

    def start_at_rest(self) -> None:
        """Rest at the present pose; called when the controller starts."""
        self._active.start_at_rest()
        self._followed = self._active.values

    def newest(self) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Return position (3,) and unit quaternion (4,) of a new pose, or None.

        Raises:
            CommandTimeoutError: The last pose has expired and the action is `stop`.
        """
        pose = self._active.newest()
        if pose is self._followed:
            return None
        self._followed = pose
        rotation = np.array(pose[3:])
        return np.array(pose[:3]), rotation / np.linalg.norm(rotation)

    def follow(self, spring: CartesianSpring) -> SpringUpdate:
        """Return the update of a controller whose one spring goes to the poses."""

        def retarget() -> None:
            pose = self.newest()
            if pose is not None:
                spring.set_target(*pose)

        return SpringUpdate(self.port, retarget, [spring], PublishTimer(0.0))
