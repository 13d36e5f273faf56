"""Which controllers move the end effector, and what held buttons and a target ask for.

A button is a dead man's switch: its browser says again and again that it is held, and
what has not been said for a moment is not so any more. The station's own watchdog
stands behind that.
"""

import math
from collections.abc import Sequence

from station.ui.operate_model import Operated
from station.ui.station_view import StationView

TWIST = ("vx", "vy", "vz", "wx", "wy", "wz")
"""Elements of a jog controller's set-point."""
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Elements of a streaming controller's set-point."""
HELD_FOR = 0.3
"""How long a button counts as held after its browser said so [s].

A browser that draws slowly says so late; that a button was let go, it says at once.
"""
PATIENCE = 3.0
"""How long a target is pursued without coming nearer [s]."""
_NEAR = 1e-4
_NEARER = 1e-4


def choose_cartesian(view: StationView, names: tuple[str, ...], kind: str) -> Operated:
    """Return the running controller that takes these elements, or why there is none.

    Args:
        view: What is known of the station.
        names: The elements.
        kind: End of the type of such controllers, e.g. `CartesianJogController`.
    """
    for controller in view.controllers:
        elements = view.elements.get(controller.name, ())
        if controller.state == "running" and (
            tuple(element.name for element in elements) == names
        ):
            return Operated(controller.name, tuple(elements), view.blocked())
    if view.blocked():
        return Operated(reason=view.blocked())
    loaded = [c.name for c in view.controllers if c.type.endswith(kind)]
    if loaded:
        return Operated(reason=f"Start {loaded[0]} in the Controllers tab.")
    if any(kind in known.type for known in view.types):
        return Operated(reason=f"Load a {kind} in the Controllers tab, and start it.")
    return Operated(reason=f"This station has no {kind}.")


class HeldButtons:
    """Which of twelve buttons are held, one per direction of each axis."""

    def __init__(self) -> None:
        self._held_at: dict[tuple[int, int], float] = {}
        self._moving = False

    def hold(self, axis: int, sign: int, now: float) -> None:
        """Note that a button is held.

        Args:
            axis: Index in `TWIST`.
            sign: 1 or -1.
            now: Monotonic time [s].
        """
        self._held_at[axis, sign] = now

    def release(self, axis: int, sign: int) -> None:
        """Note that a button was let go.

        Args:
            axis: Index in `TWIST`.
            sign: 1 or -1.
        """
        self._held_at.pop((axis, sign), None)

    def let_go(self) -> None:
        """Forget all buttons; nothing is sent for them any more."""
        self._held_at.clear()
        self._moving = False

    def twist(self, now: float, speed: float, turn: float) -> list[float] | None:
        """Return the set-point to send, zero once at the end, None when there is none.

        Args:
            now: Monotonic time [s].
            speed: Of the end effector [m/s].
            turn: Of its orientation [rad/s].
        """
        twist = [0.0] * 6
        for (axis, sign), held_at in self._held_at.items():
            if now - held_at < HELD_FOR:
                twist[axis] += sign
        moving = any(twist)
        if not moving and not self._moving:
            return None
        self._moving = moving
        return [*_of_length(twist[:3], speed), *_of_length(twist[3:], turn)]


class TargetPose:
    """A pose that somebody dragged, until the arm is there or comes no nearer."""

    def __init__(self) -> None:
        self._target: list[float] | None = None
        self._best = math.inf
        self._best_at = 0.0

    @property
    def is_pursued(self) -> bool:
        """The arm is still to go there."""
        return self._target is not None

    def drag(self, pose: Sequence[float], now: float) -> None:
        """Set the target.

        Args:
            pose: In the order of `POSE`.
            now: Monotonic time [s].
        """
        self._target = list(pose)
        self._best, self._best_at = math.inf, now

    def let_go(self) -> None:
        """Forget the target."""
        self._target = None

    def command(self, desired: Sequence[float], now: float) -> list[float] | None:
        """Return the set-point to send, or None when there is nothing to send.

        Args:
            desired: Where the controller has the end effector now, order of `POSE`.
            now: Monotonic time [s].
        """
        if self._target is None:
            return None
        away = distance(desired, self._target)
        if away < self._best - _NEARER:
            self._best, self._best_at = away, now
        target = self._target
        if away < _NEAR or now - self._best_at > PATIENCE:
            self._target = None
        return target


def distance(first: Sequence[float], second: Sequence[float]) -> float:
    """Return how far two poses are apart [m + rad], order of `POSE`."""
    cosine = abs(sum(a * b for a, b in zip(first[3:], second[3:], strict=True)))
    return math.dist(first[:3], second[:3]) + 2.0 * math.acos(min(1.0, cosine))


def _of_length(vector: Sequence[float], length: float) -> list[float]:
    size = math.hypot(*vector)
    return [length * value / size if size else 0.0 for value in vector]
