"""What one person asks of the joints of one controller: values, and held buttons.

Values travel to the robot as a set-point of limited speed, so that a far value is no
step. A held button moves its joint until it is released or its browser falls silent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from station.ui.cartesian_model import HELD_FOR
from station.ui.operate_model import POSITION_UNITS, Movers, Operated, SetPointRamp
from station.ui.station_view import StationView

AHEAD = 1.0
"""How far ahead a held button aims where a joint has no limit [rad] or [m].

More than the joint can go before the button has to be heard of again."""
UNKNOWN_START = (
    "It is not known yet where the robot was told to be. Try again in a moment."
)


@dataclass(frozen=True, slots=True)
class SetPoint:
    """A set-point to send.

    Attributes:
        controller: Which controller takes it.
        values: One number per element, in the units of the elements; None for those
            that stay as the controller was told last.
        epoch: The epoch that it is meant for; None while that is not known.
    """

    controller: str
    values: Sequence[float | None]
    epoch: int | None


class ControllerDesk:
    """The commands of one browser to one controller.

    Args:
        movers: Shared by all browsers.

    Attributes:
        operated: The controller that is commanded, or why there is none.
    """

    def __init__(self, movers: Movers) -> None:
        self.operated = Operated()
        self._movers = movers
        self._ramp = SetPointRamp((), movers)
        self._epoch: int | None = None
        self._held: dict[int, tuple[int, float]] = {}

    @property
    def remaining(self) -> float:
        """Largest distance of a joint to its target [rad] or [m]; 0 at rest."""
        return self._ramp.remaining

    def refresh(self, operated: Operated, view: StationView) -> None:
        """Look where the controller was told to be.

        After a stop, a reset or a recovery (a new epoch), and with another controller,
        the motion that was asked for before does not go on by itself.

        Args:
            operated: The controller, or why there is none.
            view: What is known of the station.
        """
        if operated.elements != self.operated.elements:
            self._ramp = SetPointRamp(operated.elements, self._movers)
        is_other = operated.name != self.operated.name or view.epoch != self._epoch
        if operated.reason or is_other:
            self.let_go()
        self.operated, self._epoch = operated, view.epoch
        sample = view.samples.get(operated.name)
        if sample is None or len(sample.desired) != len(operated.elements):
            return
        desired = [value for value in sample.desired if value is not None]
        if len(desired) == len(sample.desired):
            self._ramp.follow(desired)

    def go(self, targets: Mapping[str, float], now: float) -> str:
        """Move elements of the set-point to exact values.

        Args:
            targets: Wanted values by the name of the element, in its unit.
            now: Monotonic time [s].

        Returns:
            Why nothing was moved; empty when it is on its way.
        """
        refusal = self.refusal(targets)
        if refusal:
            return refusal
        for name, value in targets.items():
            self._held.pop(self._index(name), None)
            self._ramp.touch(self._index(name), value, now)
        return ""

    def hold(self, name: str, sign: int, now: float) -> str:
        """Move one joint for as long as its button is held.

        Args:
            name: The joint.
            sign: 1 or -1.
            now: Monotonic time [s] at which the browser said so.

        Returns:
            Why it does not move; empty when it does.
        """
        if self.operated.reason or not self.operated.name:
            return self.operated.reason or "No controller takes set-points."
        index = self._index(name)
        if index < 0:
            return f"{self.operated.name} does not command {name}."
        element = self.operated.elements[index]
        if element.unit not in POSITION_UNITS:
            return (
                f"{self.operated.name} takes {element.unit}, not positions. Type a "
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
        return [self.operated.elements[index].name for index in lost]

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
        if any(now - heard_at > HELD_FOR for _, heard_at in self._held.values()):
            self.release()
        values = self._ramp.step(dt, speed)
        if values is None:
            return None
        return SetPoint(self.operated.name, values, self._epoch)

    def refusal(self, targets: Mapping[str, float]) -> str:
        """Return why targets would be refused; empty when they would not.

        Args:
            targets: As in `go`.
        """
        if self.operated.reason or not self.operated.name:
            return self.operated.reason or "No controller takes set-points."
        for name, value in targets.items():
            index = self._index(name)
            if index < 0:
                return f"{self.operated.name} does not command {name}."
            element = self.operated.elements[index]
            low, high = element.minimum, element.maximum
            if (low is not None and value < low) or (high is not None and value > high):
                return (
                    f"{name} cannot go to {value:g} {element.unit}; allowed are "
                    f"{low:g} to {high:g} {element.unit}."
                )
        return "" if self._ramp.is_known else UNKNOWN_START

    def commands(self, name: str) -> bool:
        """Return whether the controller commands an element of that name."""
        return self._index(name) >= 0

    def _index(self, name: str) -> int:
        names = [element.name for element in self.operated.elements]
        return names.index(name) if name in names else -1
