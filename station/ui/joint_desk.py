"""What one person asks of the joints, whichever controllers command them."""

from collections.abc import Mapping

from station.ui.controller_desk import ControllerDesk, SetPoint
from station.ui.operate_model import Movers, choose_all_operated
from station.ui.station_view import StationView

SLOWEST, FASTEST = 0.02, 1.5
"""Range of the speed of a joint that a person may choose [rad/s] or [m/s]."""


class JointDesk:
    """The joint commands of one browser.

    Args:
        movers: Shared by all browsers.

    Attributes:
        speed: Fastest change of a position [rad/s] or [m/s].
    """

    def __init__(self, movers: Movers | None = None) -> None:
        self.speed = 0.5
        self._movers = Movers() if movers is None else movers
        self._desks = [ControllerDesk(self._movers)]

    @property
    def controllers(self) -> list[str]:
        """The controllers that are commanded; empty when there is none."""
        return [desk.operated.name for desk in self._desks if desk.operated.name]

    @property
    def reason(self) -> str:
        """Why nothing can be commanded; empty when something can."""
        return self._desks[0].operated.reason

    @property
    def remaining(self) -> float:
        """Largest distance of a joint to its target [rad] or [m]; 0 at rest."""
        return max(desk.remaining for desk in self._desks)

    def refresh(self, view: StationView) -> None:
        """Look which controllers run, and where they were told to be.

        After a stop, a reset or a recovery (a new epoch), and with another controller,
        the motion that was asked for before does not go on by itself.
        """
        known = {desk.operated.name: desk for desk in self._desks}
        chosen = choose_all_operated(view)
        self._desks = [
            known.get(one.name) or ControllerDesk(self._movers) for one in chosen
        ]
        for desk, operated in zip(self._desks, chosen, strict=True):
            desk.refresh(operated, view)

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
        parts: dict[ControllerDesk, dict[str, float]] = {}
        for name, value in targets.items():
            parts.setdefault(self._desk_of(name), {})[name] = value
        refusals = [desk.refusal(part) for desk, part in parts.items()]
        if any(refusals):
            return next(filter(None, refusals))
        for desk, part in parts.items():
            desk.go(part, now)
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
        return self._desk_of(name).hold(name, sign, now)

    def release(self) -> None:
        """Stop the motion of all held buttons."""
        for desk in self._desks:
            desk.release()

    def let_go(self) -> None:
        """Forget every motion, and send no more for it."""
        for desk in self._desks:
            desk.let_go()

    def give_up_lost(self) -> list[str]:
        """End the motion of the joints that somebody else has moved since.

        Returns:
            Their names.
        """
        return [name for desk in self._desks for name in desk.give_up_lost()]

    def confirm(self, controller: str) -> None:
        """Note that the station took the last set-point of a controller."""
        for desk in self._desks:
            if desk.operated.name == controller:
                desk.confirm()

    def step(self, dt: float, now: float) -> list[SetPoint]:
        """Return the next set-points to send, at most one for each controller.

        Args:
            dt: Time since the last step [s].
            now: Monotonic time [s].
        """
        steps = (desk.step(dt, self.speed, now) for desk in self._desks)
        return [set_point for set_point in steps if set_point is not None]

    def _desk_of(self, name: str) -> ControllerDesk:
        """Return the desk of a joint's controller; else the first, to refuse it."""
        return next((d for d in self._desks if d.commands(name)), self._desks[0])
