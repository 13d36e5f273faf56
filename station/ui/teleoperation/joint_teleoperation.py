"""The commands of one person to joints: values, and buttons held down.

Values travel to the robot as set-points of limited speed, so that a far value is no
step. A held button moves its joint until it is released or its browser falls silent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from station.ui.link.station_view import POSITION_UNITS, StationView
from station.ui.teleoperation.commanded_controller import (
    CommandedController,
    choose_for_joints,
)
from station.ui.teleoperation.set_point_ramp import Movers, SetPointRamp
from station.wire import CommandElement

HELD_FOR = 0.3
"""Time for which a button counts as held after the last message of its browser [s].

A browser that draws slowly repeats the message late, but reports a release at once.
"""
AHEAD = 1.0
"""Distance that a held button aims ahead where a joint has no limit [rad] or [m].

It is more than the joint can go before the button has to be heard of again.
"""
SLOWEST, FASTEST = 0.02, 1.5
"""Range of the speed of a joint that a person may choose [rad/s] or [m/s]."""
UNKNOWN_START = (
    "It is not known yet where the robot was told to be. Try again in a moment."
)


@dataclass(frozen=True, slots=True)
class SetPoint:
    """A set-point to send.

    Attributes:
        controller: The controller that takes it.
        values: One number per element, in the units of the elements; None for those
            that stay as the controller was told last.
        epoch: The epoch that it is meant for; None while that is not known.
    """

    controller: str
    values: Sequence[float | None]
    epoch: int | None


class ControllerTeleoperation:
    """The commands of one person to one controller of joints.

    Args:
        movers: Shared by everybody who commands joints.

    Attributes:
        commanded: The controller, or why there is none.
    """

    def __init__(self, movers: Movers) -> None:
        self.commanded = CommandedController()
        self._movers = movers
        self._ramp = SetPointRamp((), movers)
        self._epoch: int | None = None
        self._held: dict[int, tuple[int, float]] = {}

    @property
    def remaining(self) -> float:
        """Largest distance of a joint to its target [rad] or [m]; 0 at rest."""
        return self._ramp.remaining

    def refresh(self, commanded: CommandedController, view: StationView) -> None:
        """Note which controller runs, and its last set-point.

        Args:
            commanded: The controller, or why there is none.
            view: The dashboard's knowledge of the station.
        """
        if commanded.elements != self.commanded.elements:
            self._ramp = SetPointRamp(commanded.elements, self._movers)
        # After a stop, a reset or a recovery (a new epoch), and with another
        # controller, a motion that was asked for before must not go on by itself.
        is_other = commanded.name != self.commanded.name or view.epoch != self._epoch
        if commanded.reason or is_other:
            self.let_go()
        self.commanded, self._epoch = commanded, view.epoch
        set_point = view.set_point_of(commanded.name, len(commanded.elements))
        if set_point is not None:
            self._ramp.follow(set_point)

    def go(self, targets: Mapping[str, float], now: float) -> str:
        """Move elements of the set-point to exact values.

        Args:
            targets: Wanted values by the name of the element, in its unit.
            now: Monotonic time [s].

        Returns:
            Why nothing was moved; empty when it is on its way.
        """
        refusal = self.refusal(targets)
        if not refusal:
            for name, value in targets.items():
                self._held.pop(self._index(name), None)
                self._ramp.touch(self._index(name), value, now)
        return refusal

    def hold(self, name: str, sign: int, now: float) -> str:
        """Move one joint for as long as its button is held.

        Args:
            name: The joint.
            sign: 1 or -1.
            now: Monotonic time [s] at which the browser said so.

        Returns:
            Why it does not move; empty when it does.
        """
        refusal = self._refusal_of(name)
        if refusal:
            return refusal
        index = self._index(name)
        element = self.commanded.elements[index]
        if element.unit not in POSITION_UNITS:
            return (
                f"{self.commanded.name} takes {element.unit}, not positions. Type a "
                "value, or start a position controller to jog."
            )
        start = self._ramp.present(index)
        if start is None:
            return UNKNOWN_START
        if index in self._held and self._ramp.has_lost(index):
            return ""  # The next step ends it, and says so.
        end = element.maximum if sign > 0 else element.minimum
        self._ramp.touch(index, start + sign * AHEAD if end is None else end, now)
        self._held[index] = (sign, now)
        return ""

    def release(self) -> None:
        """Stop the motion of all held buttons."""
        self._ramp.halt(self._held)
        self._held.clear()

    def let_go(self) -> None:
        """Forget every motion, and send no more for it."""
        self._held.clear()
        self._ramp.let_go()

    def give_up_lost(self) -> list[str]:
        """End the motion of the joints that somebody else has moved since.

        Returns:
            Their names.
        """
        lost = self._ramp.give_up_lost()
        for index in lost:
            self._held.pop(index, None)
        return [self.commanded.elements[index].name for index in lost]

    def confirm(self) -> None:
        """Note that the station took the last set-point."""
        self._ramp.confirm()

    def step(self, dt: float, speed: float, now: float) -> SetPoint | None:
        """Return the next set-point to send, or None when there is nothing to send.

        Args:
            dt: Time since the last step [s].
            speed: Fastest change of a position [rad/s] or [m/s], > 0.
            now: Monotonic time [s].
        """
        # A browser that hangs or is cut off reports no release.
        if any(now - heard_at > HELD_FOR for _, heard_at in self._held.values()):
            self.release()
        values = self._ramp.step(dt, speed)
        if values is None:
            return None
        return SetPoint(self.commanded.name, values, self._epoch)

    def refusal(self, targets: Mapping[str, float]) -> str:
        """Return why targets would be refused; empty when they would not.

        Args:
            targets: As in `go`.
        """
        for name, value in targets.items():
            refusal = self._refusal_of(name)
            if refusal:
                return refusal
            element = self.commanded.elements[self._index(name)]
            low, high = element.minimum, element.maximum
            if (low is not None and value < low) or (high is not None and value > high):
                return (
                    f"{name} cannot go to {value:g} {element.unit}; allowed are "
                    f"{low:g} to {high:g} {element.unit}."
                )
        return "" if self._ramp.is_known else UNKNOWN_START

    def shown(self, name: str, now: float) -> float | None:
        """Return the value that a slider shows; None to leave the slider as it is.

        Args:
            name: The element.
            now: Monotonic time [s].
        """
        return self._ramp.shown(self._index(name), now)

    def commands(self, name: str) -> bool:
        """Return whether the controller commands an element of that name."""
        return self._index(name) >= 0

    def _refusal_of(self, name: str) -> str:
        """Return why an element cannot be moved; empty when it can."""
        if self.commanded.reason or not self.commanded.name:
            return self.commanded.reason or "No controller takes set-points."
        if not self.commands(name):
            return f"{self.commanded.name} does not command {name}."
        return ""

    def _index(self, name: str) -> int:
        names = [element.name for element in self.commanded.elements]
        return names.index(name) if name in names else -1


class JointTeleoperation:
    """The joint commands of one person, whichever controllers take them.

    Args:
        movers: Shared by everybody who commands joints.

    Attributes:
        speed: Fastest change of a position [rad/s] or [m/s].
    """

    def __init__(self, movers: Movers | None = None) -> None:
        self.speed = 0.5
        self._movers = Movers() if movers is None else movers
        self._parts = [ControllerTeleoperation(self._movers)]

    @property
    def controllers(self) -> list[str]:
        """The controllers that are commanded; empty when there is none."""
        return [part.commanded.name for part in self._parts if part.commanded.name]

    @property
    def elements(self) -> tuple[CommandElement, ...]:
        """The numbers that can be commanded; empty when there is no controller."""
        return tuple(one for part in self._parts for one in part.commanded.elements)

    @property
    def reason(self) -> str:
        """Why nothing can be commanded; empty when something can."""
        return self._parts[0].commanded.reason

    @property
    def remaining(self) -> float:
        """Largest distance of a joint to its target [rad] or [m]; 0 at rest."""
        return max(part.remaining for part in self._parts)

    def refresh(self, view: StationView) -> None:
        """Note which controllers run, and their last set-points."""
        known = {part.commanded.name: part for part in self._parts}
        chosen = choose_for_joints(view)
        self._parts = [
            known.get(one.name) or ControllerTeleoperation(self._movers)
            for one in chosen
        ]
        for part, commanded in zip(self._parts, chosen, strict=True):
            part.refresh(commanded, view)

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
        shares: dict[ControllerTeleoperation, dict[str, float]] = {}
        for name, value in targets.items():
            shares.setdefault(self._part_of(name), {})[name] = value
        refusals = [part.refusal(share) for part, share in shares.items()]
        if any(refusals):
            return next(filter(None, refusals))
        for part, share in shares.items():
            part.go(share, now)
        return ""

    def hold(self, name: str, sign: int, now: float) -> str:
        """Move one joint while its button is held; see `ControllerTeleoperation`."""
        return self._part_of(name).hold(name, sign, now)

    def shown(self, name: str, now: float) -> float | None:
        """Return the value of a slider; see `ControllerTeleoperation`."""
        return self._part_of(name).shown(name, now)

    def release(self) -> None:
        """Stop the motion of all held buttons."""
        for part in self._parts:
            part.release()

    def let_go(self) -> None:
        """Forget every motion, and send no more for it."""
        for part in self._parts:
            part.let_go()

    def give_up_lost(self) -> list[str]:
        """End the motion of the joints that somebody else has moved since.

        Returns:
            Their names.
        """
        return [name for part in self._parts for name in part.give_up_lost()]

    def confirm(self, controller: str) -> None:
        """Note that the station took the last set-point of a controller."""
        for part in self._parts:
            if part.commanded.name == controller:
                part.confirm()

    def step(self, dt: float, now: float) -> list[SetPoint]:
        """Return the next set-points to send, at most one for each controller.

        Args:
            dt: Time since the last step [s].
            now: Monotonic time [s].
        """
        steps = (part.step(dt, self.speed, now) for part in self._parts)
        return [set_point for set_point in steps if set_point is not None]

    def _part_of(self, name: str) -> ControllerTeleoperation:
        """Return the part of a joint's controller; else the first, which refuses it."""
        return next((p for p in self._parts if p.commands(name)), self._parts[0])
