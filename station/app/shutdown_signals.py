"""Turn Ctrl-C or SIGTERM into an orderly end, a second one into an immediate end."""

import os
import select
import signal
from collections.abc import Callable
from types import FrameType
from typing import Self

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class ShutdownSignals:
    """Waits for signals; a context manager for the main thread.

    Until the first call of `wait`, a signal raises `KeyboardInterrupt`, so that it
    aborts a start. Afterwards the first signal ends `wait`, and a further signal calls
    `at_once` and ends the process.

    Args:
        at_once: Kills the processes that must not outlive this one; must not block.
    """

    def __init__(self, at_once: Callable[[], None]) -> None:
        self._at_once = at_once
        self._waiting = False
        self._count = 0
        self._previous: dict[signal.Signals, object] = {}

    def __enter__(self) -> Self:
        # A handler may write to a pipe, but not take the lock of an Event or Queue.
        # A SimpleQueue has none, but its `get` never returns after a signal whose
        # handling outlasts the timeout, e.g. when the process was suspended.
        self._received, self._sent = os.pipe()
        for number in _SIGNALS:
            self._previous[number] = signal.signal(number, self._handle)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)  # type: ignore[arg-type]  # as it was returned
        os.close(self._received)
        os.close(self._sent)

    def wait(self, timeout: float) -> bool:
        """Wait `timeout` [s] at most for a signal; return whether one came."""
        self._waiting = True
        return bool(select.select([self._received], [], [], timeout)[0])

    def _handle(self, number: int, _: FrameType | None) -> None:
        self._count += 1
        if self._count > 1:
            self._at_once()
            os._exit(128 + number)
        if not self._waiting:
            raise KeyboardInterrupt
        os.write(self._sent, b".")
