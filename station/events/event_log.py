"""The event log: recording never waits; a thread of its own writes to disk."""

import json
import logging
import sqlite3
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from station.core.user_files import make_private_folder
from station.events.event_file import (
    MAX_TEXT,
    STATION,
    EventFile,
    Origin,
    written_details,
)
from station.reports import Event, EventKind, Severity

MAX_EVENTS = 50_000
"""Events that are kept on disk; the oldest are deleted first."""
MAX_AGE = 90 * 86400.0
"""Events older than this are deleted [s]."""
IN_MEMORY = 2048
"""Newest events that are also in memory, for readers that must not wait for a disk."""
MAX_PENDING = 8192
"""Most events that wait for the disk; beyond it, the oldest are dropped and counted."""
BATCH = 256
"""Most events of one transaction."""
RETRY_PERIOD = 1.0
"""Time from a failure to the next attempt to write [s]."""
_PRUNE_EVERY = 500
"""Number of events that are written between two deletions of old ones."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class EventLogState:
    """The state of the event log.

    Attributes:
        newest_id: Number of the newest event; 0 when there is none.
        pending: Events that are not on disk yet.
        lost: Events that this run has not been able to keep on disk.
        failure: Why events are not written at the moment; None while they are.
        path: The file; None when events are kept in memory only.
    """

    newest_id: int
    pending: int
    lost: int
    failure: str | None
    path: Path | None


class EventLog:
    """Takes events from any thread, calls listeners, keeps the events on disk.

    Recording takes a lock for some microseconds and never touches the disk. It is not
    for the control thread, which must not take locks at all.

    Args:
        path: The file; None keeps the newest events in memory only, without a thread.
        boot_id: Random name of this run.
        station_time: Function that returns station time [s] and the number of the last
            cycle.
        now: Wall time [s since 1970].
        max_events: Events kept on disk, >= 1.
        max_age: Events older than this are deleted [s], > 0.
    """

    def __init__(
        self,
        path: Path | None = None,
        *,
        boot_id: str = "",
        station_time: Callable[[], tuple[float, int]] = lambda: (0.0, 0),
        now: Callable[[], float] = time.time,
        max_events: int = MAX_EVENTS,
        max_age: float = MAX_AGE,
    ) -> None:
        self._path = path
        self._boot_id = boot_id
        self._station_time = station_time
        self._now = now
        self._max_events = max_events
        self._max_age = max_age
        self._lock = threading.Lock()
        self._recent: deque[Event] = deque(maxlen=IN_MEMORY)
        self._pending: deque[Event] = deque()
        self._listeners: dict[object, Callable[[Event], None]] = {}
        self._lost = 0
        self._failure: str | None = None
        self._written = 0
        self._wake = threading.Event()
        self._is_closed = threading.Event()
        self._file = None if path is None else self._open(path)
        self._newest = 0
        if self._file is not None:
            self._newest = self._file.newest_id()
            self._recent.extend(self._file.read_newest(self._newest + 1, IN_MEMORY))
        self._thread: threading.Thread | None = None
        if self._file is not None:
            self._thread = threading.Thread(
                target=self._write_until_closed, name="events", daemon=True
            )
            self._thread.start()

    def record(
        self,
        kind: EventKind,
        text: str,
        *,
        severity: Severity = Severity.INFO,
        what: str = "",
        result: str = "",
        details: Mapping[str, object] | None = None,
        origin: Origin = STATION,
    ) -> Event:
        """Record that something happened; return the event.

        Args:
            kind: Kind of the event.
            text: A sentence for people; cut off after `MAX_TEXT` characters.
            severity: Severity of the event.
            what: Method and route, or the subject.
            result: How it ended, in one or two words.
            details: More facts; types that JSON does not have are kept as text.
            origin: Person or program that did it, and its address.
        """
        stamp, cycle = self._station_time()
        # Convert the details now, so that memory and disk give the same values,
        # whatever objects the caller has passed.
        plain = json.loads(written_details(details or {}))
        with self._lock:
            event = Event(
                id=self._newest + 1,
                time=self._now(),
                stamp=stamp,
                cycle=cycle,
                kind=kind,
                severity=severity,
                who=origin.who[:MAX_TEXT],
                where=origin.where[:MAX_TEXT],
                what=what[:MAX_TEXT],
                result=result[:MAX_TEXT],
                text=text[:MAX_TEXT],
                details=plain,
                request_id=origin.request_id,
                boot_id=self._boot_id,
            )
            self._newest = event.id
            self._recent.append(event)
            self._queue(event)
            for key, listener in list(self._listeners.items()):
                self._tell(key, listener, event)
        # Wake the writer outside of the lock, which it takes as its first step.
        self._wake.set()
        return event

    def listen(self, callback: Callable[[Event], None]) -> Callable[[], None]:
        """Call `callback` with every event from now on, in order.

        The recording thread calls it, so it must return at once and must not record
        events. A callback that raises an error is not called again.

        Returns:
            A function that ends the calls.
        """
        key = object()
        with self._lock:
            self._listeners[key] = callback

        def end() -> None:
            with self._lock:
                self._listeners.pop(key, None)

        return end

    def wall_time(self) -> float:
        """Return the wall time by which events are stamped [s since 1970, UTC]."""
        return self._now()

    @property
    def newest_id(self) -> int:
        """Number of the newest event; 0 when there is none."""
        return self._newest

    def is_in_memory(self, after: int) -> bool:
        """Return whether all events after a number are kept in memory."""
        with self._lock:
            return self._covers(after)

    def recent(self, after: int) -> list[Event]:
        """Return the events in memory after a number, oldest first; never waits."""
        with self._lock:
            return [event for event in self._recent if event.id > after]

    def since(
        self,
        after: int = 0,
        limit: int = 100,
        kinds: Collection[EventKind] = (),
        severity: Severity = Severity.INFO,
    ) -> list[Event]:
        """Return events after a number, oldest first.

        Reads the disk when the memory does not go back so far. An event that could not
        be written is found in memory only.

        Args:
            after: Number of the last event that the reader has; 0 for none.
            limit: Most events that are returned, >= 1.
            kinds: Kinds of the events; all when empty.
            severity: Least severity of the events.
        """
        with self._lock:
            file = None if self._covers(after) else self._file
            recent = [
                event
                for event in self._recent
                if event.id > after
                and (not kinds or event.kind in kinds)
                and event.severity.rank >= severity.rank
            ]
        found: list[Event] = []
        if file is not None:
            try:
                found = file.read(after, limit, kinds, severity)
            except (sqlite3.Error, ValueError) as error:
                _log.warning("Events cannot be read from %s: %s", file.path, error)
        # An event that disk and memory both have is returned once.
        last = found[-1].id if found else after
        # If the disk fills the page, the events that only memory has come on later
        # pages.
        newer = [] if len(found) >= limit else [e for e in recent if e.id > last]
        return (found + newer)[:limit]

    def newest(
        self,
        limit: int,
        kinds: Collection[EventKind] = (),
        severity: Severity = Severity.INFO,
    ) -> list[Event]:
        """Return the newest events, oldest first.

        Reads the disk when the memory has fewer than `limit` of them.

        Args:
            limit: Most events that are returned, >= 1.
            kinds: Kinds of the events; all when empty.
            severity: Least severity of the events.
        """
        with self._lock:
            recent, file = list(self._recent), self._file
        found = [
            event
            for event in recent
            if (not kinds or event.kind in kinds)
            and event.severity.rank >= severity.rank
        ][-limit:]
        missing = limit - len(found)
        if missing and file is not None and recent:
            before = recent[0].id
            try:
                older = file.read_newest(before, missing, kinds, severity)
            except (sqlite3.Error, ValueError) as error:
                _log.warning("Events cannot be read from %s: %s", file.path, error)
            else:
                found = older + found
        return found

    def state(self) -> EventLogState:
        """Return the state of the log."""
        with self._lock:
            return EventLogState(
                newest_id=self._newest,
                pending=len(self._pending),
                lost=self._lost,
                failure=self._failure,
                path=self._path,
            )

    def close(self, timeout: float = 1.0) -> None:
        """Write the pending events and end the thread.

        Args:
            timeout: Longest wait [s].
        """
        self._is_closed.set()
        self._wake.set()
        if self._thread is not None:
            self._thread.join(timeout)

    def _covers(self, after: int) -> bool:
        oldest = self._recent[0].id if self._recent else self._newest + 1
        return after >= oldest - 1

    def _queue(self, event: Event) -> None:
        if self._path is None:
            return
        # The file could not be opened: the event counts as lost on disk, but stays in
        # memory.
        if self._file is None:
            self._lost += 1
            return
        self._pending.append(event)
        if len(self._pending) > MAX_PENDING:
            self._pending.popleft()
            self._lost += 1

    def _tell(
        self, key: object, listener: Callable[[Event], None], event: Event
    ) -> None:
        try:
            listener(event)
        except Exception:  # noqa: BLE001 - a request must not fail by a listener
            del self._listeners[key]
            _log.exception("A listener to events failed and hears no more of them.")

    def _open(self, path: Path) -> EventFile | None:
        """Return the opened file; a file that is not an event file is moved aside."""
        try:
            make_private_folder(path.parent)
            return _open_or_replace(path)
        except (sqlite3.Error, OSError) as error:
            self._failure = f"{path} cannot be opened: {error}."
            _log.warning("Events are kept in memory alone: %s", self._failure)
            return None

    def _write_until_closed(self) -> None:
        while not self._is_closed.is_set():
            self._wake.wait()
            self._wake.clear()
            while self._pending and not self._is_closed.is_set():
                if not self._write_batch():
                    self._is_closed.wait(RETRY_PERIOD)
        while self._pending and self._write_batch():
            pass
        if self._file is not None:
            self._file.close()

    def _write_batch(self) -> bool:
        """Write the oldest pending events; return whether they are written."""
        file = self._file
        if file is None:
            return False
        with self._lock:
            # The events stay pending until they are written, so that a failure loses
            # none.
            batch = [self._pending[i] for i in range(min(BATCH, len(self._pending)))]
        try:
            file.append(batch)
            self._prune(file, len(batch))
        except (sqlite3.Error, OSError) as error:
            self._note_failure(f"{file.path}: {error}")
            return False
        last = batch[-1].id
        with self._lock:
            # Remove them by number: the oldest may have been dropped while the disk was
            # busy.
            while self._pending and self._pending[0].id <= last:
                self._pending.popleft()
            failure, self._failure = self._failure, None
        if failure is not None:
            text = f"Events are written to disk again; {self._lost} were lost."
            _log.warning(text)
            self.record(EventKind.EVENTS, text, result="written")
        return True

    def _prune(self, file: EventFile, written: int) -> None:
        self._written += written
        if self._written >= _PRUNE_EVERY:
            self._written = 0
            file.prune(self._max_events, self._now() - self._max_age)

    def _note_failure(self, why: str) -> None:
        with self._lock:
            is_new = self._failure is None
            self._failure = why
        if is_new:
            text = f"Events cannot be written and are kept in memory: {why}"
            _log.warning(text)
            self.record(
                EventKind.EVENTS, text, severity=Severity.ERROR, result="not written"
            )


def _open_or_replace(path: Path) -> EventFile:
    try:
        return EventFile(path)
    # The file is locked or the disk is full; the events in the file are sound.
    except sqlite3.OperationalError:
        raise
    except sqlite3.DatabaseError as error:
        aside = path.with_name(f"{path.name}.damaged")
        path.replace(aside)
        _log.warning("%s is damaged (%s); moved to %s.", path, error, aside)
        return EventFile(path)
