"""A push of one body of the simulated world from outside."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from station.core.errors import HardwareInterfaceError

WORLD = "world"
"""Name of the world's own axes."""


@dataclass(frozen=True, slots=True)
class Push:
    """A force and a torque on a body.

    Attributes:
        body: Name of a link that has mass, or of an object.
        force: Force [N], shape (3,).
        torque: Torque [Nm], shape (3,).
        frame: Frame in whose axes force and torque are given: the world, or a body,
            with which they turn.
        point: Point of application, in the body's frame [m], shape (3,); None
            for its centre of mass.
    """

    body: str
    force: tuple[float, ...]
    torque: tuple[float, ...] = (0.0, 0.0, 0.0)
    frame: str = WORLD
    point: tuple[float, ...] | None = None


class AppliedPush:
    """A push that lasts for some steps. For the thread that steps the world.

    Args:
        model: The world's model.
        data: The world's data.
        push: The push.
        steps: Duration in time steps, >= 0.

    Attributes:
        left: Number of remaining time steps.

    Raises:
        HardwareInterfaceError: The world has no such body.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, push: Push, steps: int
    ) -> None:
        self.body = _find_body(model, push.body)
        self._frame = 0 if push.frame == WORLD else _find_body(model, push.frame)
        self._data = data
        self._force, self._torque = np.array(push.force), np.array(push.torque)
        self._point = None if push.point is None else np.array(push.point)
        self.left = steps
        # Only a push that turns or moves with a body is computed anew in each step.
        self._is_constant = not self._frame and self._point is None
        self._apply()

    def is_over(self) -> bool:
        """Count a step; return whether the push has ended."""
        if self.left <= 0:
            self.end()
            return True
        self.left -= 1
        if not self._is_constant:
            self._apply()
        return False

    def end(self) -> None:
        """Remove the force and the torque from the body."""
        self._data.xfrc_applied[self.body] = 0.0

    def _apply(self) -> None:
        data = self._data
        axes = data.xmat[self._frame].reshape(3, 3)
        force, torque = axes @ self._force, axes @ self._torque
        if self._point is not None:
            turned = data.xmat[self.body].reshape(3, 3) @ self._point
            arm = data.xpos[self.body] + turned - data.xipos[self.body]
            torque = torque + np.cross(arm, force)
        data.xfrc_applied[self.body] = [*force, *torque]


def as_push(
    body: str,
    force: Sequence[float],
    torque: Sequence[float],
    *,
    frame: str = WORLD,
    point: Sequence[float] | None = None,
) -> Push:
    """Return a push with copies of the numbers."""
    at = None if point is None else tuple(point)
    return Push(body, tuple(force), tuple(torque), frame, at)


def _find_body(model: mujoco.MjModel, name: str) -> int:
    number: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if number <= 0:
        known = [model.body(i).name for i in range(1, model.nbody)]
        raise HardwareInterfaceError(
            f"The simulated world has no body {name!r}.",
            remedy=f"Choose among {', '.join(known) or 'none'}.",
            details={"body": name},
        )
    return number
