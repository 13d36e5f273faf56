"""The commands of one person to end effectors: held directions, and poses.

A button is a hold-to-run switch. While a button is held, its browser repeats a message;
when the messages stay away for a moment, the button counts as released. If the
dashboard itself fails, the controller's `command_timeout` ends the motion.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from station.core.description.urdf import Pose
from station.ui.link.station_view import POSE, TWIST, StationView
from station.ui.teleoperation.commanded_controller import (
    CommandedController,
    arms_to_move,
    choose_for_hand,
)
from station.ui.teleoperation.joint_teleoperation import HELD_FOR, SetPoint

JOG_KIND = "CartesianJogController"
TARGET_KIND = "CartesianStreamingController"
SLOWEST_HAND = 0.005
"""Slowest speed of a held direction that a person may choose [m/s] or [rad/s]."""
PATIENCE = 3.0
"""Time after which a target is given up when the arm comes no nearer [s]."""
STEPS_ADD_UP = 1.5
"""Steps that follow each other within this time begin where the last one ends [s]."""
_NEAR = 1e-4
_NEARER = 1e-4
_FIRST_TURN = 3


@dataclass(frozen=True, slots=True)
class HandSpeed:
    """The speed at which held buttons move an end effector.

    Attributes:
        along: Speed of a held direction [m/s].
        about: Angular speed of a held direction [rad/s].
    """

    along: float = 0.05
    about: float = 0.3


class HeldButtons:
    """The state of twelve buttons, one per direction of each axis."""

    def __init__(self) -> None:
        self._held: dict[tuple[int, bool], tuple[float, float]] = {}
        self._moving = False

    def hold(self, axis: int, sign: float, now: float) -> None:
        """Note that a button is held.

        Args:
            axis: Index in `TWIST`.
            sign: 1 or -1, or the deflection of a stick between them.
            now: Monotonic time [s].
        """
        # A stick has one deflection on its way; two buttons at once cancel.
        if abs(sign) < 1.0:
            self._held.pop((axis, sign <= 0.0), None)
        self._held[axis, sign > 0.0] = (sign, now)

    def release(self) -> None:
        """Treat all buttons as released; the next twist is zero."""
        self._held.clear()

    def let_go(self) -> None:
        """Treat all buttons as released, and send nothing further for them."""
        self._held.clear()
        self._moving = False

    def twist(self, now: float, speed: HandSpeed) -> list[float] | None:
        """Return the twist to send; after a motion zero once, and then None.

        Args:
            now: Monotonic time [s].
            speed: Speed of the end effector.
        """
        twist = [0.0] * 6
        for (axis, _), (sign, held_at) in self._held.items():
            if now - held_at < HELD_FOR:
                twist[axis] += sign
        moving = any(twist)
        if not moving and not self._moving:
            return None
        self._moving = moving
        along, about = twist[:_FIRST_TURN], twist[_FIRST_TURN:]
        return [*_at_most(along, speed.along), *_at_most(about, speed.about)]


class TargetPose:
    """A wanted pose, kept until the arm has reached it or comes no nearer."""

    def __init__(self) -> None:
        self._target: list[float] | None = None
        self._best = math.inf
        self._best_at = 0.0

    @property
    def is_pursued(self) -> bool:
        """Return whether the arm has yet to reach the target."""
        return self._target is not None

    def set(self, pose: Sequence[float], now: float) -> None:
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
        # The controller stops before a joint limit or a singular pose; a target beyond
        # one would be sent for ever.
        if away < _NEAR or now - self._best_at > PATIENCE:
            self._target = None
        return target


class HandTeleoperation:
    """The commands of one person to one end effector.

    Args:
        arm: The arm that carries it; empty unless there are several.

    Attributes:
        jog: The controller that held buttons command, or the reason for none.
        target: The controller that moves to a pose, or the reason for none.
        message: Why the motion waits or slows down; empty when it does not.
        speed: The speed of held buttons, unless the controller allows less.
        desired: The last pose of the set-point, in the order of `POSE`;
            None while unknown.
    """

    def __init__(self, arm: str = "") -> None:
        self.jog = CommandedController()
        self.target = CommandedController()
        self.message = ""
        self.speed = HandSpeed()
        self.desired: list[float] | None = None
        self._arm = arm
        self._epoch: int | None = None
        self._buttons = HeldButtons()
        self._pose = TargetPose()
        self._place: Pose | None = None
        self._stepped_at, self._stepped = -math.inf, [0.0]

    @property
    def is_pursuing(self) -> bool:
        """Return whether the hand has yet to reach its target."""
        return self._pose.is_pursued

    def refresh(self, view: StationView) -> None:
        """Note the running controllers; a new epoch ends earlier requests."""
        jog = choose_for_hand(view, TWIST, JOG_KIND, self._arm)
        target = choose_for_hand(view, POSE, TARGET_KIND, self._arm)
        is_other = view.epoch != self._epoch
        if jog.reason or is_other or jog.name != self.jog.name:
            self._buttons.let_go()
        if target.reason or is_other or target.name != self.target.name:
            self._pose.let_go()
            self._stepped_at = -math.inf
        self.jog, self.target, self._epoch = jog, target, view.epoch
        messages = (view.messages.get(one.name, "") for one in (jog, target))
        self.message = next(filter(None, messages), "")
        self.desired = view.set_point_of(target.name, len(POSE))
        arm = view.arms.get(self._arm) or next(iter(view.arms.values()), None)
        tool = None if arm is None else arm.tool
        self._place = _as_pose(self.desired) if self.desired else tool

    @property
    def fastest(self) -> HandSpeed | None:
        """The limits of the jog controller; None without limits or controller."""
        if len(self.jog.elements) != len(TWIST):
            return None
        along = self.jog.elements[0].maximum
        about = self.jog.elements[_FIRST_TURN].maximum
        return None if along is None or about is None else HandSpeed(along, about)

    def hold(self, axis: int, sign: float, now: float) -> str:
        """Move along or about an axis for as long as its button is held.

        Args:
            axis: Index in `TWIST`.
            sign: 1 or -1, or the deflection of a stick between them.
            now: Monotonic time of the browser's message [s].

        Returns:
            Why it does not move; empty when it does.
        """
        if self.jog.reason or not self.jog.name:
            return self.jog.reason
        self._buttons.hold(axis, sign, now)
        return ""

    def go(self, pose: Sequence[float], now: float, step_in: str = "") -> str:
        """Go to a pose, or one step further.

        Args:
            pose: x, y, z in the arm's base [m], or all of `POSE`; the orientation stays
                as it is without one.
            now: Monotonic time [s].
            step_in: Frame, `base` or `tool`, in whose axes `pose` is a step; empty if
                `pose` is a target.

        Returns:
            Why it does not move; empty when it does.
        """
        if self.target.reason or not self.target.name:
            return self.target.reason
        if self.desired is None:
            return "The last set-point of the hand is not known yet. Try again."
        wanted = [*pose, *self.desired[len(pose) :]]
        if step_in:
            is_first = now - self._stepped_at > STEPS_ADD_UP
            start = _as_pose(self.desired if is_first else self._stepped)
            made = start.moved(_as_pose(pose), is_by_own_axes=step_in == "tool")
            wanted = [*made.xyz, *made.quaternion[1:], made.quaternion[0]]
        self._stepped_at, self._stepped = now if step_in else -math.inf, wanted
        self._pose.set(wanted, now)
        return ""

    def release(self) -> None:
        """Treat all held buttons as released; the next step commands rest."""
        self._buttons.release()

    def let_go(self) -> None:
        """Forget every motion, and send nothing further."""
        self._buttons.let_go()
        self._pose.let_go()

    def step(self, now: float) -> SetPoint | None:
        """Return the next set-point to send, or None when there is nothing to send.

        Args:
            now: Monotonic time [s].
        """
        most = self.fastest or self.speed
        speed = HandSpeed(
            min(self.speed.along, most.along), min(self.speed.about, most.about)
        )
        twist = self._buttons.twist(now, speed)
        if twist is not None:
            return SetPoint(self.jog.name, twist, self._epoch)
        if self.desired is None:
            return None
        pose = self._pose.command(self.desired, now)
        return None if pose is None else SetPoint(self.target.name, pose, self._epoch)

    def state(self) -> dict[str, object]:
        """Return the controllers of the hand and their speeds, ready for JSON."""
        most, here = self.fastest, self._place
        return {
            "jog": {"controller": self.jog.name, "reason": self.jog.reason},
            "target": {"controller": self.target.name, "reason": self.target.reason},
            "message": self.message,
            "fastest": None if most is None else [most.along, most.about],
            "place": here and [*here.xyz, *here.rpy()],
        }


class HandsTeleoperation:
    """The commands of one person to the end effectors of all arms."""

    def __init__(self) -> None:
        self._hands = {"": HandTeleoperation()}
        self._speed = HandSpeed()

    def refresh(self, view: StationView) -> None:
        """Note which arms there are, and which controllers run."""
        known = self._hands
        arms = arms_to_move(view)
        self._hands = {arm: known.get(arm) or HandTeleoperation(arm) for arm in arms}
        for hand in self._hands.values():
            hand.speed = self._speed
            hand.refresh(view)

    @property
    def is_pursuing(self) -> bool:
        """Return whether a hand has yet to reach its target."""
        return any(hand.is_pursuing for hand in self._hands.values())

    def of(self, arm: str) -> HandTeleoperation | None:
        """Return the hand of an arm; if there is only one, any name returns it."""
        return self._hands.get(arm, self._hands.get(""))

    def targets(self) -> set[str]:
        """Return the running controllers that go to poses."""
        names = {hand.target.name for hand in self._hands.values()}
        return names - {""}

    def set_speed(self, along: float, about: float) -> None:
        """Limit the speed of held directions.

        Args:
            along: Speed [m/s]; at least `SLOWEST_HAND`.
            about: Angular speed [rad/s]; at least `SLOWEST_HAND`.
        """
        self._speed = HandSpeed(max(along, SLOWEST_HAND), max(about, SLOWEST_HAND))

    def hold(self, arm: str, axis: int, sign: float, now: float) -> str:
        """Move one hand while a button is held; see `HandTeleoperation`."""
        hand = self.of(arm)
        return _no_arm(arm) if hand is None else hand.hold(axis, sign, now)

    def go(self, arm: str, pose: Sequence[float], now: float, step_in: str = "") -> str:
        """Let one hand go to a pose or one step; see `HandTeleoperation`."""
        hand = self.of(arm)
        return _no_arm(arm) if hand is None else hand.go(pose, now, step_in)

    def release(self) -> None:
        """Treat all held buttons as released; the next step commands rest."""
        for hand in self._hands.values():
            hand.release()

    def let_go(self) -> None:
        """Forget every motion, and send nothing further."""
        for hand in self._hands.values():
            hand.let_go()

    def step(self, now: float) -> list[SetPoint]:
        """Return the next set-points to send, at most one for each hand."""
        steps = (hand.step(now) for hand in self._hands.values())
        return [set_point for set_point in steps if set_point is not None]

    def state(self) -> dict[str, object]:
        """Return the state of each hand by its arm, ready for JSON."""
        return {arm: hand.state() for arm, hand in self._hands.items()}


def distance(first: Sequence[float], second: Sequence[float]) -> float:
    """Return the distance between two poses [m + rad], in the order of `POSE`."""
    cosine = abs(sum(a * b for a, b in zip(first[3:], second[3:], strict=True)))
    # Rounding may bring the cosine of two equal orientations above 1.
    return math.dist(first[:3], second[:3]) + 2.0 * math.acos(min(1.0, cosine))


def _as_pose(pose: Sequence[float]) -> Pose:
    x, y, z, qx, qy, qz, qw = pose
    return Pose((x, y, z), (qw, qx, qy, qz))


def _at_most(vector: Sequence[float], length: float) -> list[float]:
    size = max(math.hypot(*vector), 1.0)
    return [length * value / size for value in vector]


def _no_arm(arm: str) -> str:
    return f"This station has no arm '{arm}'."
