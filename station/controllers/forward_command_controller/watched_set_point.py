"""The set-point in force: the newest valid set-point, or rest."""

from collections.abc import Callable

from station.controllers.forward_command_controller.command_timeout import TimeoutAction
from station.controllers.forward_command_controller.set_point_update import (
    SetPointInForce,
)
from station.core.errors import CommandTimeoutError
from station.core.ports.set_point import SetPointPort
from station.memory.doubles import put


class WatchedSetPoint(SetPointInForce):
    """Takes set-points from a port, and replaces expired ones by rest. Control thread.

    Args:
        port: Receives the set-points.
        action: What happens when the newest set-point expires.
        subject: Name of what is commanded, for messages.
        rest: Returns the set-point at which the robot rests, shape (n,).

    Attributes:
        values: The set-point in force, shape (n,); never changed, only replaced.
        rates: Rates at which the set-point changes, shape (n,); empty when unknown.
    """

    def __init__(
        self,
        port: SetPointPort,
        action: TimeoutAction,
        subject: str,
        rest: Callable[[], list[float]],
    ) -> None:
        super().__init__(port.news, len(port.elements))
        self._port = port
        self._action = action
        self._subject = subject
        self._rest = rest
        self.values: list[float] = []
        self.rates: list[float] = []

    def begin(self) -> None:
        """Make rest the set-point; called when the controller starts."""
        self._put_in_force(self._rest(), [])

    def newest(self) -> list[float]:
        """Return the set-point in force, shape (n,); the caller must not change it.

        The set-point is clamped to the ranges of its elements. Rest replaces a
        set-point that has expired, or that a stop, a reset or a recovery made void.

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        if self.news.is_possible() and self._port.has_news():
            self._take_news()
        return self.values

    def _take_news(self) -> None:
        port = self._port
        if port.take_void():
            self.begin()
        newest = port.take()
        if newest is not None:
            # Set-points may be posted unchecked, so they are clamped once more here.
            # After the values come the rates, if the set-point has any.
            values = [
                min(max(value, element.minimum), element.maximum)
                for value, element in zip(newest, port.elements, strict=False)
            ]
            self._put_in_force(values, newest[len(values) :])
        if port.take_expiry():
            self._end()

    def _put_in_force(self, values: list[float], rates: list[float]) -> None:
        put(self.desired, values)
        if rates:
            put(self.desired_rates, rates)
        self.has_rates = bool(rates)
        self.values, self.rates = values, rates

    def _end(self) -> None:
        if self._action is TimeoutAction.STOP:
            raise CommandTimeoutError(
                f"No set-point for {self._subject} arrived in time.",
                remedy="Restart the controller, and send set-points more often than "
                "its `command_timeout` demands.",
            )
        self.begin()
        self._port.last = self.values
