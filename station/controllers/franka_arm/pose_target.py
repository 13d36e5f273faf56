"""The pose in force: a set-point of position [m] and quaternion w x y z."""

from collections.abc import Callable
from math import inf

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm.cartesian_spring import (
    CartesianSpring,
    SpringUpdate,
)
from station.controllers.franka_arm.pose_port import PosePort
from station.core.parameters import Parameters
from station.core.ports.set_point import ActiveSetPoint, read_command_timeout
from station.core.toolbox.publish_timer import PublishTimer

_LENGTH_TOLERANCE = 1e-3


class PoseTarget:
    """The target pose: the newest set-point, or rest once that has expired.

    Args:
        params: `command_timeout` and `command_timeout_action`, see `TimeoutAction`.
        subject: Name of what is commanded, for messages.
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
