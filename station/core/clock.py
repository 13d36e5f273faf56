"""Clocks: the operating system's for the real loop, and a manual one for tests."""

import threading
import time
from abc import ABC, abstractmethod
from typing import final

from typing_extensions import override

from station.memory.wall_time import VirtualTime


class Clock(ABC):
    """A monotonic clock that can wait.

    Code that needs wall time is given a `Clock` and never calls `time.*` itself, so
    that tests decide how time passes. Safe to use from any thread.
    """

    @abstractmethod
    def now(self) -> float:
        """Return monotonic time [s]; its origin has no meaning."""

    @abstractmethod
    def sleep_until(self, deadline: float) -> None:
        """Wait until `now() >= deadline` [s]; return at once if it has passed."""

    @abstractmethod
    def wait_for(self, lock: threading.Lock, deadline: float) -> bool:
        """Acquire `lock`, waiting until `deadline` [s] at most.

        Returns:
            Whether the lock was acquired.
        """


class SystemClock(Clock):
    """The operating system's monotonic clock."""

    # The function itself, without a method around it, because the loop reads the clock
    # four times in a cycle.
    now = staticmethod(time.monotonic)

    @override
    def sleep_until(self, deadline: float) -> None:
        delay = deadline - time.monotonic()
        if delay > 0.0:
            time.sleep(delay)

    @override
    def wait_for(self, lock: threading.Lock, deadline: float) -> bool:
        return lock.acquire(timeout=max(deadline - time.monotonic(), 0.0))


class ManualClock(VirtualTime, Clock):
    """A clock that stands still until someone advances it.

    `sleep_until` advances the clock instead of waiting, so that code under test
    runs as fast as it can and every run is the same.

    Args:
        start: First value of `now()` [s]. The default is a large, unusual number, so
            that a time of another clock stands out in a failing test.
    """

    def __init__(self, start: float = 7_654_321.0) -> None:
        super().__init__(start)

    @final
    @override
    def now(self) -> float:
        return self.seconds

    def advance(self, duration: float) -> None:
        """Move the clock forward by `duration` [s], >= 0.

        Raises:
            ValueError: `duration` is negative; time only goes forward.
        """
        if duration < 0.0:
            raise ValueError(
                f"The clock cannot be advanced by {duration} s; allowed are times >= 0."
            )
        self.seconds += duration

    @override
    def sleep_until(self, deadline: float) -> None:
        self.seconds = max(self.seconds, deadline)

    @override
    def wait_for(self, lock: threading.Lock, deadline: float) -> bool:
        if lock.acquire(blocking=False):
            return True
        self.sleep_until(deadline)
        return False
