"""A stop that latches: engaged in an instant, released in two deliberate steps."""

from enum import Enum

from station.core.errors import StoppedError


class StopState(Enum):
    """The states of the latched stop."""

    ARMED = "armed"
    """Motion is possible."""
    STOPPED = "stopped"
    """All controllers were stopped; nothing may move."""
    RELEASED = "released"
    """The cause is gone; motion must still be armed."""


class StopLatch:
    """The software stop of the station. Not a safety device.

    `engage` only sets a flag, so it cannot fail or wait; the control loop sees the
    flag at its next cycle and stops every controller. Any thread may call it.

    Attributes:
        state: State of the latch.
        flag: One byte, not 0 from `engage` until the loop has carried the stop out.
        reason: Why it was engaged last, for people.
        cycle: The cycle in which the last stop was carried out; 0 if none was.
    """

    def __init__(self) -> None:
        # A byte of memory, because every cycle reads it.
        self.flag = bytearray(1)
        self.state = StopState.ARMED
        self.reason = ""
        self.cycle = 0
        self._engagements = 0

    @property
    def pending(self) -> bool:
        """Return whether the stop is engaged and the loop has yet to carry it out."""
        return self.flag[0] != 0

    def engage(self, reason: str) -> None:
        """Engage the stop; a second call changes only the reason."""
        # Counted before the state changes, so that `_change` notices a stop that comes
        # in between.
        self._engagements += 1
        self.reason = reason
        self.flag[0] = 1
        self.state = StopState.STOPPED

    def carried_out(self, cycle: int) -> None:
        """Note that the loop has stopped everything in `cycle` (control thread)."""
        self.flag[0] = 0
        self.cycle = cycle

    def release(self) -> None:
        """Take the first step of a release: the cause is gone. Nothing moves yet.

        Raises:
            StoppedError: The stop has not been carried out yet.
        """
        before = self._engagements
        if self.state is not StopState.STOPPED:
            return
        # A stop that is released before the loop carries it out would stop nothing.
        if self.pending:
            raise StoppedError(
                f"The stop ({self.reason}) is not carried out yet.",
                remedy="Release it again in a moment, and see whether cycles run.",
                details={"stop_state": self.state.value, "reason": self.reason},
            )
        self._change(StopState.RELEASED, before)

    def arm(self) -> None:
        """Second step: allow motion again. Nothing resumes by itself.

        Raises:
            StoppedError: The stop was not released first.
        """
        before = self._engagements
        if self.state is StopState.STOPPED:
            raise StoppedError(
                f"The station is stopped ({self.reason}); release it before arming.",
                remedy="Release the stop first, then arm it.",
            )
        self._change(StopState.ARMED, before)

    def _change(self, state: StopState, before: int) -> None:
        # A stop may come from any thread at any point of this method; it wins.
        self.state = state
        if self._engagements != before:
            self.state = StopState.STOPPED

    def check(self) -> None:
        """Refuse motion unless the station is armed.

        Raises:
            StoppedError: The station is stopped, or released but not armed.
        """
        if self.state is not StopState.ARMED:
            raise StoppedError(
                f"The station is {self.state.value} ({self.reason}); nothing may move.",
                remedy="Release the stop, then arm it.",
                details={"stop_state": self.state.value, "reason": self.reason},
            )
