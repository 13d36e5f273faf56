"""Requests to an arm whose answers come later: a motion's end, a stop, a recovery."""

from station.core.errors import ArmCommandError
from station.hw.franka.fci.driver.arm_link import ArmLink
from station.hw.franka.fci.driver.refusals import refusal_of
from station.hw.franka.fci.wire.robot_protocol import Command


class PendingRequests:
    """Sends requests without waiting, and takes their answers. Control thread.

    Args:
        link: The link to the arm.

    Attributes:
        failure: Why the last motion, stop or recovery failed; empty if none did.
    """

    def __init__(self, link: ArmLink) -> None:
        self._link = link
        self._waiting: list[int] = []
        self._stop: int | None = None
        self._recovery: int | None = None
        self.failure = ""

    @property
    def is_stopping(self) -> bool:
        """Whether the answer to a stop is due."""
        return self._stop is not None

    @property
    def is_recovering(self) -> bool:
        """Whether the answer to a recovery is due."""
        return self._recovery is not None

    def stop(self) -> bool:
        """Ask for a stop; return whether the arm was there to be asked."""
        try:
            self._stop = self._link.send(Command.STOP_MOVE)
        except ArmCommandError:
            return False
        self._waiting.append(self._stop)
        return True

    def recover(self) -> None:
        """Ask for a recovery.

        Raises:
            ArmCommandError: The arm is lost.
        """
        self.failure = ""
        self._recovery = self._link.send(Command.AUTOMATIC_ERROR_RECOVERY)
        self._waiting.append(self._recovery)

    def expect(self, number: int) -> None:
        """Take the answer to a request that was sent before, once it is there."""
        self._waiting.append(number)

    def look(self) -> None:
        """Look whether the arm has answered; once per cycle."""
        if not self._waiting:
            return
        for number in list(self._waiting):
            answer = self._link.take(number)
            if answer is None:
                continue
            self._waiting.remove(number)
            self._stop = None if number == self._stop else self._stop
            self._recovery = None if number == self._recovery else self._recovery
            if answer.status:  # 0 is success for every command
                mode = self._link.reader.robot_mode
                self.failure = refusal_of(answer.command, answer.status, mode)

    def clear(self) -> None:
        """Expect nothing any more: the arm is lost."""
        self._waiting.clear()
        self._stop = self._recovery = None
