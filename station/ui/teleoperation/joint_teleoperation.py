"""The commands of one person to joints: values, and buttons held down.

A value is sent to the robot as set-points of limited speed, so that a distant value
does not make a step. A held button moves its joint until it is released or its browser
falls silent. After anything unexpected (a stop, another controller, a refusal) nothing
more is sent.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from station.ui.link.station_view import POSITION_UNITS, StationView
from station.ui.teleoperation.commanded_controller import (
    CommandedController,
    choose_for_joints,
)
from station.wire import CommandElement

HELD_FOR = 0.3
"""Time for which a button counts as held after the last message of its browser [s].

A browser that draws slowly repeats the message late, but reports a release at once.
"""
AHEAD = 1.0
"""Distance that a held button aims ahead where a joint has no limit [rad] or [m].

This is more than a joint moves before the button's next message is due.
"""
SHOWN_FOR = 1.0
"""Time for which a released slider keeps its value before it follows the robot [s]."""
SLOWEST, FASTEST = 0.02, 1.5
"""Range of the speed of a joint that a person may choose [rad/s] or [m/s]."""
UNKNOWN_START = (
    "The last set-point of the robot is not known yet. Try again in a moment."
)


class Movers:
    """The mover of each joint; the last request wins. Any thread."""

    def __init__(self) -> None:
        self._of: dict[str, object] = {}

    def take(self, joint: str, mover: object) -> None:
        """Let `mover` alone move a joint from now on."""
        self._of[joint] = mover

    def has_lost(self, joint: str, mover: object) -> bool:
        """Return whether another mover has taken a joint that `mover` took."""
        return self._of.get(joint) is not mover


@dataclass(frozen=True, slots=True)
class SetPoint:
    """A set-point to send.

    Attributes:
        controller: The controller that takes it.
        values: One number per element, in the units of the elements; None for those
            that stay as they are.
        epoch: The epoch that it is meant for; None while that is not known.
    """

    controller: str
    values: Sequence[float | None]
    epoch: int | None


@dataclass(slots=True)
class _Motion:
    """A joint that moves to a value.

    Attributes:
        target: The wanted value.
        current: The value of the last set-point.
        held_at: Time of the last message about its button [s]; None for a typed value.
        is_confirmed: Whether the station has taken a set-point of the motion.
    """

    target: float
    current: float
    held_at: float | None = None
    is_confirmed: bool = False


class JointTeleoperation:
    """The joint commands of one person, whichever controllers take them.

    It commands only the joints that it moves, so that another client may move the other
    joints meanwhile.

    Args:
        movers: The mover of each joint, shared by all that command joints.

    Attributes:
        speed: Fastest change of a position [rad/s] or [m/s]; other quantities are sent
            as they are.
    """

    def __init__(self, movers: Movers | None = None) -> None:
        self.speed = 0.5
        self._movers = Movers() if movers is None else movers
        self._chosen: tuple[CommandedController, ...] = (CommandedController(),)
        self._epoch: int | None = None
        self._last: dict[str, float] = {}  # the last set-points
        self._motions: dict[str, _Motion] = {}
        self._unconfirmed: dict[str, list[str]] = {}  # joints by controller
        self._touched_at: dict[str, float] = {}

    @property
    def controllers(self) -> list[str]:
        """The controllers that are commanded; empty when there is none."""
        return [one.name for one in self._chosen if one.name]

    @property
    def elements(self) -> tuple[CommandElement, ...]:
        """The numbers that can be commanded; empty when there is no controller."""
        return tuple(element for one in self._chosen for element in one.elements)

    @property
    def reason(self) -> str:
        """Return the reason why nothing can be commanded; empty when something can."""
        return self._chosen[0].reason

    @property
    def is_pursuing(self) -> bool:
        """Return whether a joint has yet to reach a typed value."""
        return any(one.held_at is None for one in self._motions.values())

    @property
    def remaining(self) -> float:
        """Largest distance of a joint to its target [rad] or [m]; 0 at rest."""
        away = (abs(one.target - one.current) for one in self._motions.values())
        return max(away, default=0.0)

    def refresh(self, view: StationView) -> None:
        """Note which controllers run, and their last set-points."""
        chosen = choose_for_joints(view)
        # After a stop, a reset or a recovery (a new epoch), and with another
        # controller, a motion that was asked for before must not go on by itself.
        if view.epoch != self._epoch:
            self.let_go()
        kept = {
            element.name
            for one in chosen
            if one in self._chosen
            for element in one.elements
        }
        self._forget(set(self._last) | set(self._motions), but=kept)
        self._chosen, self._epoch = chosen, view.epoch
        for one in chosen:
            values = view.set_point_of(one.name, len(one.elements))
            if values is not None:
                names = (element.name for element in one.elements)
                self._last |= dict(zip(names, values, strict=True))

    def set_speed(self, speed: float) -> None:
        """Limit the speed of a position.

        Args:
            speed: Wanted speed [rad/s] or [m/s]; kept within `SLOWEST` and `FASTEST`.
        """
        self.speed = min(max(speed, SLOWEST), FASTEST)

    def go(self, targets: Mapping[str, float], now: float) -> str:
        """Move elements of the set-points to exact values: all of them, or none.

        Args:
            targets: Wanted values by the name of the element, in its unit.
            now: Monotonic time [s].

        Returns:
            Why nothing was moved; empty when it is on its way.
        """
        refusals = (self._refusal_of(name, value) for name, value in targets.items())
        refusal = next(filter(None, refusals), "")
        if not refusal:
            for name, value in targets.items():
                self._touch(name, value, now)
        return refusal

    def hold(self, name: str, sign: int, now: float) -> str:
        """Move one joint for as long as its button is held.

        Args:
            name: The joint.
            sign: 1 or -1.
            now: Monotonic time of the browser's message [s].

        Returns:
            Why it does not move; empty when it does.
        """
        refusal = self._refusal_of(name)
        if refusal:
            return refusal
        controller, element = self._found(name)
        if element.unit not in POSITION_UNITS:
            return (
                f"{controller.name} takes {element.unit}, not positions. Type a value, "
                "or start a position controller to jog."
            )
        motion = self._motions.get(name)
        # The next step ends the motion, and says so; it must not be asked for anew by
        # a button that was held before.
        if motion is not None and motion.held_at is not None and self._has_lost(name):
            return ""
        end = element.maximum if sign > 0 else element.minimum
        ahead = self._present(name) + sign * AHEAD
        self._touch(name, ahead if end is None else end, now, held_at=now)
        return ""

    def release(self) -> None:
        """Stop the motion of all held buttons."""
        self._halt([n for n, one in self._motions.items() if one.held_at is not None])

    def let_go(self) -> None:
        """Forget every motion, and send nothing further."""
        # The last set-points are not known until a sample has them.
        self._forget(set(self._last) | set(self._motions))

    def give_up_lost(self) -> list[str]:
        """End the motion of the joints that another mover has moved since.

        Returns:
            Their names.
        """
        lost = [name for name in self._motions if self._has_lost(name)]
        for name in lost:
            del self._motions[name]
        return lost

    def confirm(self, controller: str) -> None:
        """Note that the station took the last set-point of a controller.

        Only now does another person's motion of the same joints end, because the
        station might have refused the set-point.
        """
        for name in self._unconfirmed.pop(controller, ()):
            self._movers.take(name, self)
            if name in self._motions:
                self._motions[name].is_confirmed = True

    def step(self, dt: float, now: float) -> list[SetPoint]:
        """Return the next set-points to send, at most one for each controller.

        Args:
            dt: Time since the last step [s].
            now: Monotonic time [s].
        """
        # A browser that hangs or is cut off reports no release.
        self._halt([
            name
            for name, one in self._motions.items()
            if one.held_at is not None and now - one.held_at > HELD_FOR
        ])
        steps = (self._step_of(one, self.speed * dt) for one in self._chosen)
        return [set_point for set_point in steps if set_point is not None]

    def shown(self, name: str, now: float) -> float | None:
        """Return the value that a slider shows; None to leave the slider as it is.

        Args:
            name: The element.
            now: Monotonic time [s].
        """
        if now - self._touched_at.get(name, float("-inf")) < SHOWN_FOR:
            return None
        motion = self._motions.get(name)
        return self._last.get(name) if motion is None else motion.target

    def _step_of(
        self, controller: CommandedController, reach: float
    ) -> SetPoint | None:
        moved = [one for one in controller.elements if one.name in self._motions]
        if not moved:
            return None
        motions = self._motions
        self._unconfirmed[controller.name] = [
            one.name for one in moved if not motions[one.name].is_confirmed
        ]
        values: dict[str, float] = {}
        for element in moved:
            motion = motions[element.name]
            away = motion.target - motion.current
            if element.unit in POSITION_UNITS and abs(away) > reach:
                motion.current += reach if away > 0.0 else -reach
            else:
                # The target itself, so that a typed value arrives exactly.
                motion.current = motion.target
                self._last[element.name] = motion.target
                del motions[element.name]
            values[element.name] = motion.current
        command = [values.get(element.name) for element in controller.elements]
        return SetPoint(controller.name, command, self._epoch)

    def _touch(
        self, name: str, target: float, now: float, held_at: float | None = None
    ) -> None:
        motion = self._motions.get(name)
        # What is asked for anew is the later motion: the station has to take it first.
        is_confirmed = (
            motion is not None and motion.is_confirmed and not self._has_lost(name)
        )
        start = self._present(name)
        self._motions[name] = _Motion(target, start, held_at, is_confirmed)
        self._touched_at[name] = now

    def _halt(self, names: Iterable[str]) -> None:
        """Let joints stay at their last set-points."""
        for name in names:
            self._last[name] = self._motions.pop(name).current
            self._touched_at.pop(name, None)

    def _forget(self, names: Iterable[str], but: Collection[str] = ()) -> None:
        for name in names:
            if name not in but:
                for known in (self._last, self._motions, self._touched_at):
                    known.pop(name, None)

    def _has_lost(self, name: str) -> bool:
        """Return whether another mover has moved a joint since it was touched."""
        return self._motions[name].is_confirmed and self._movers.has_lost(name, self)

    def _present(self, name: str) -> float:
        motion = self._motions.get(name)
        return self._last[name] if motion is None else motion.current

    def _found(self, name: str) -> tuple[CommandedController, CommandElement]:
        return next(
            (one, element)
            for one in self._chosen
            for element in one.elements
            if element.name == name
        )

    def _refusal_of(self, name: str, target: float | None = None) -> str:
        """Return the reason why an element cannot be moved there; empty if it can."""
        if not any(element.name == name for element in self.elements):
            first = self._chosen[0]
            if first.reason or not first.name:
                return first.reason or "No controller takes set-points."
            return f"{first.name} does not command {name}."
        controller, element = self._found(name)
        low, high = element.minimum, element.maximum
        if controller.reason:
            return controller.reason
        if target is not None and (
            (low is not None and target < low) or (high is not None and target > high)
        ):
            return (
                f"{name} cannot go to {target:g} {element.unit}; allowed are "
                f"{low:g} to {high:g} {element.unit}."
            )
        is_known = name in self._last or name in self._motions
        return "" if is_known else UNKNOWN_START
