"""Choose the controller that moves the end effector, and compute its set-points.

A button is a hold-to-run switch. While a button is held, its browser repeats a message;
when the messages stay away for a moment, the button counts as released. If the
dashboard itself fails, the controller's `command_timeout` ends the motion.
"""

import math
from collections.abc import Sequence
from itertools import zip_longest

from station.ui.controllers_model import arms_of
from station.ui.operate_model import Operated
from station.ui.station_view import StationView

TWIST = ("vx", "vy", "vz", "wx", "wy", "wz")
"""Elements of a jog controller's set-point."""
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Elements of a streaming controller's set-point."""
HELD_FOR = 0.3
"""Time for which a button counts as held after the last message of its browser [s].

A browser that draws slowly repeats the message late, but reports a release at once.
"""
PATIENCE = 3.0
"""Time after which a target is given up when the arm comes no nearer [s]."""
_NEAR = 1e-4
_NEARER = 1e-4


def choose_cartesian(
    view: StationView, names: tuple[str, ...], kind: str, arm: str = ""
) -> Operated:
    """Return the running controller that takes these elements, or why there is none.

    Args:
        view: What is known of the station.
        names: The elements.
        kind: End of the type of such controllers, e.g. `CartesianJogController`.
        arm: The arm whose end effector is moved; empty where there is one at most.
    """
    controllers = [c for c in view.controllers if not arm or arm in arms_of(view, c)]
    for controller in controllers:
        elements = view.elements.get(controller.name, ())
        if controller.state == "running" and (
            tuple(element.name for element in elements) == names
        ):
            return Operated(controller.name, tuple(elements), view.blocked())
    if view.blocked():
        return Operated(reason=view.blocked())
    loaded = [c.name for c in controllers if c.type.endswith(kind)]
    if loaded:
        return Operated(reason=f"Start {loaded[0]} in the Controllers tab.")
    if any(kind in known.type for known in view.types):
        what = f"{kind} of {arm}" if arm else kind
        return Operated(reason=f"Load a {what} in the Controllers tab, and start it.")
    return Operated(reason=f"This station has no {kind}.")


class HeldButtons:
    """The state of twelve buttons, one per direction of each axis."""

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
        """Note that a button was released.

        Args:
            axis: Index in `TWIST`.
            sign: 1 or -1.
        """
        self._held_at.pop((axis, sign), None)

    def let_go(self) -> None:
        """Treat all buttons as released, and send no more for them."""
        self._held_at.clear()
        self._moving = False

    def twist(self, now: float, speed: float, turn: float) -> list[float] | None:
        """Return the set-point to send: one zero after a motion, then None.

        Args:
            now: Monotonic time [s].
            speed: Speed of the end effector [m/s].
            turn: Angular speed of the end effector [rad/s].
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
    """A dragged pose, kept until the arm has reached it or comes no nearer."""

    def __init__(self) -> None:
        self._target: list[float] | None = None
        self._best = math.inf
        self._best_at = 0.0

    @property
    def is_pursued(self) -> bool:
        """Whether the arm has yet to reach the target."""
        return self._target is not None

    def drag(self, pose: Sequence[float], now: float) -> None:
        """Set the target.

        Args:
            pose: Position [m] and quaternion, in the order of `POSE`.
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
            desired: Present desired pose of the controller, in the order of `POSE`.
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


def arms_to_move(view: StationView) -> list[str]:
    """Return the arms between which a person chooses.

    Returns:
        One empty name where there are not several: any controller is of that arm.
    """
    arms = [] if view.status is None else [arm.arm_id for arm in view.status.robots]
    return arms if len(arms) > 1 else [""]


def bases_of_hands(arms: Sequence[str], bases: Sequence[str]) -> dict[str, str]:
    """Return the scene node of the base of each hand that can be moved, by arm.

    Args:
        arms: The arms that are drawn.
        bases: Scene nodes of their bases; fewer where a robot could not be drawn.

    Returns:
        One entry under an empty name where there are not several arms.
    """
    if len(arms) < 2:
        return {"": bases[0] if bases else ""}
    return dict(zip_longest(arms, bases[: len(arms)], fillvalue=""))


def distance(first: Sequence[float], second: Sequence[float]) -> float:
    """Return the distance between two poses [m + rad], in the order of `POSE`."""
    cosine = abs(sum(a * b for a, b in zip(first[3:], second[3:], strict=True)))
    return math.dist(first[:3], second[:3]) + 2.0 * math.acos(min(1.0, cosine))


def _of_length(vector: Sequence[float], length: float) -> list[float]:
    size = math.hypot(*vector)
    return [length * value / size if size else 0.0 for value in vector]
