"""Repeated events: recorded a few times and then counted."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from station.events.event_file import Origin
from station.events.event_log import EventLog
from station.reports import Event, EventKind, Severity

WINDOW = 10.0
"""Repeats within this time are counted together [s]."""
FREE = 10
"""Number of alike events in a window that are recorded one by one."""
MOST_KINDS = 512
"""Most windows at a time; beyond it, the oldest window is reported and ends."""


@dataclass(slots=True)
class _Window:
    first: Event
    begin: float
    seen: int = 1
    counted: int = 0


class Repeats:
    """Passes events on to a log, and counts those that repeat. Any thread.

    A program that sends set-points a thousand times a second, or a client that tries
    tokens, would otherwise push all other events out of the log. No repeat is lost:
    their number is recorded when their window ends.

    Args:
        log: Takes the events.
        now: Monotonic clock [s].
    """

    def __init__(self, log: EventLog, now: Callable[[], float]) -> None:
        self._log = log
        self._now = now
        self._lock = threading.Lock()
        self._windows: dict[tuple[str, ...], _Window] = {}

    def record(
        self,
        kind: EventKind,
        text: str,
        *,
        severity: Severity = Severity.INFO,
        what: str,
        result: str,
        details: Mapping[str, object] | None = None,
        origin: Origin,
        free: int = FREE,
    ) -> None:
        """Record an event, or count it.

        Args:
            kind: Kind of the event.
            text: A sentence for people.
            severity: Severity of the event.
            what: Method and route, or the subject.
            result: How it ended.
            details: More facts of the event.
            origin: Person or program that did it, and its address.
            free: Number of alike events in a window that are recorded one by one, >= 1.
        """
        key = (kind.value, origin.who, origin.where, what, result)
        now = self._now()
        with self._lock:
            window = self._windows.get(key)
            if window is not None and now - window.begin < WINDOW:
                window.seen += 1
                if window.seen > free:
                    window.counted += 1
                    return
                window = None
            elif window is not None:
                del self._windows[key]
                self._tell(window)
            event = self._log.record(
                kind,
                text,
                severity=severity,
                what=what,
                result=result,
                details=details,
                origin=origin,
            )
            if key not in self._windows:
                self._windows[key] = _Window(event, now)
                self._forget()

    def flush(self) -> None:
        """Record the counts of the windows that have ended."""
        now = self._now()
        with self._lock:
            for key, window in list(self._windows.items()):
                if now - window.begin >= WINDOW:
                    del self._windows[key]
                    self._tell(window)

    def finish(self) -> None:
        """Record the counts of all windows, when the station ends."""
        with self._lock:
            for window in self._windows.values():
                self._tell(window)
            self._windows.clear()

    def _forget(self) -> None:
        # A client that varies its requests must not make the memory grow.
        if len(self._windows) > MOST_KINDS:
            self._tell(self._windows.pop(next(iter(self._windows))))

    def _tell(self, window: _Window) -> None:
        if not window.counted:
            return
        event = window.first
        times = "once more" if window.counted == 1 else f"{window.counted} more times"
        self._log.record(
            event.kind,
            f"{times} within {WINDOW:.0f} s: {event.text}",
            severity=event.severity,
            what=event.what,
            result=event.result,
            details={"repeated": window.counted, "first_event": event.id},
            origin=Origin(event.who, event.where),
        )
