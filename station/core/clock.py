"""Time as a dependency: the wall clock for the real loop, a manual one for tests."""

import threading
import time
from abc import ABC, abstractmethod

from typing_extensions import override


class Clock(ABC):
    """A monotonic clock that can wait.

    Everything in the station that needs wall time gets a `Clock`; nothing calls
    `time.*` itself. Safe to use from any thread.
    """

    @abstractmethod
    def now(self) -> float:
        """Return monotonic time [s]; its origin has no meaning."""

    @abstractmethod
    def sleep_until(self, deadline: float) -> None:
        """Return when `now() >= deadline` [s]; at once when it has passed."""

    @abstractmethod
    def wait_for(self, lock: threading.Lock, deadline: float) -> bool:
        """Acquire `lock`, waiting for it until `deadline` [s] at most.

        Returns:
            Whether it was acquired.
        """


class SystemClock(Clock):
    """The operating system's monotonic clock."""

    @override
    def now(self) -> float:
        return time.monotonic()

    @override
    def sleep_until(self, deadline: float) -> None:
        delay = deadline - time.monotonic()
        if delay > 0.0:
            time.sleep(delay)

    @override
    def wait_for(self, lock: threading.Lock, deadline: float) -> bool:
        return lock.acquire(timeout=max(deadline - time.monotonic(), 0.0))


class ManualClock(Clock):
    """A clock that stands still until someone advances it.

    `sleep_until` advances the clock instead of waiting, so that code under test
    runs as fast as it can and every run is the same.

    Args:
        start: First value of `now()` [s]. It is large and odd by default, so that a
            value of another clock mixed in is seen at once.
    """

    def __init__(self, start: float = 7_654_321.0) -> None:
        self._now = start

    @override
    def now(self) -> float:
        return self._now

    def advance(self, duration: float) -> None:
        """Move the clock forward by `duration` [s], >= 0.

        Raises:
            ValueError: `duration` is negative; time only goes forward.
        """
        if duration < 0.0:
            raise ValueError(f"cannot advance the clock by {duration} s; use >= 0")
        self._now += duration

    @override
    def sleep_until(self, deadline: float) -> None:
        self._now = max(self._now, deadline)

    @override
    def wait_for(self, lock: threading.Lock, deadline: float) -> bool:
        if lock.acquire(blocking=False):
            return True
        self.sleep_until(deadline)
        return False
