"""The set-point in force: the newest one, or rest when there is none any more."""

from collections.abc import Callable

from station.controllers.forward_command_controller.command_timeout import TimeoutAction
from station.core.errors import CommandTimeoutError
from station.core.ports.set_point import SetPointPort


class WatchedSetPoint:
    """Picks set-points up and replaces those that are no longer valid. Control thread.

    Args:
        port: Where they arrive.
        action: What follows when the newest is no longer valid.
        subject: What is commanded, for messages.
        rest: Returns the set-point that lets the robot rest, shape (n,).

    Attributes:
        values: The set-point in force, shape (n,); never changed, only replaced.
        rates: How fast it changes, shape (n,); empty when unknown.
    """

    def __init__(
        self,
        port: SetPointPort,
        action: TimeoutAction,
        subject: str,
        rest: Callable[[], list[float]],
    ) -> None:
        self._port = port
        self._action = action
        self._subject = subject
        self._rest = rest
        self.values: list[float] = []
        self.rates: list[float] = []

    def begin(self) -> None:
        """Rest; call it when the controller starts."""
        self.values, self.rates = self._rest(), []

    def newest(self) -> list[float]:
        """Return the set-point in force, shape (n,); never change the list.

        It is kept within the ranges of its elements, whoever posted it. When it is no
        longer valid, or was made void by a stop, a reset or a recovery, rest takes its
        place.

        Raises:
            CommandTimeoutError: It is no longer valid and the action is `stop`.
        """
        port = self._port
        if port.take_void():
            self.begin()
        newest = port.take()
        if newest is not None:
            # The rates follow the values, if there are any.
            self.values = [
                min(max(value, element.minimum), element.maximum)
                for value, element in zip(newest, port.elements, strict=False)
            ]
            self.rates = newest[len(self.values) :]
        if port.take_expiry():
            self._end()
        return self.values

    def _end(self) -> None:
        if self._action is TimeoutAction.STOP:
            raise CommandTimeoutError(
                f"No set-point for {self._subject} arrived in time.",
                remedy="Start the controller again and send set-points at a faster "
                "pace than its timeout.",
            )
        self.begin()
        self._port.last = self.values
