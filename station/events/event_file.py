"""Events with their origins, kept in an SQLite file that is bounded in number and age.

Events are appended in batches. The write-ahead log survives the death of the process at
any moment: events that were written before a `kill -9` are in the file afterwards.
"""

import json
import sqlite3
from collections.abc import Collection, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from station.reports import Event, EventKind, Severity

_COLUMNS = (
    "id, time, stamp, cycle, kind, severity, who, origin, what, result, text, details, "
    "request_id, boot_id"
)
_TABLE = """
CREATE TABLE IF NOT EXISTS events (
    id INTEGER PRIMARY KEY, time REAL NOT NULL, stamp REAL NOT NULL,
    cycle INTEGER NOT NULL, kind TEXT NOT NULL, severity INTEGER NOT NULL,
    who TEXT NOT NULL, origin TEXT NOT NULL, what TEXT NOT NULL, result TEXT NOT NULL,
    text TEXT NOT NULL, details TEXT NOT NULL, request_id TEXT NOT NULL,
    boot_id TEXT NOT NULL
)
"""
_INSERT = f"INSERT OR IGNORE INTO events ({_COLUMNS}) VALUES ({', '.join('?' * 14)})"
BUSY_TIMEOUT = 2.0
"""Longest wait for another connection to the file [s]."""
_SEVERITIES = tuple(Severity)
MAX_TEXT = 500
"""Longest text that an event keeps [characters]; the rest is cut off."""
MAX_DETAILS = 4000
"""Longest details as JSON [characters]; longer ones become one text that is cut off."""


class EventFile:
    """A file of events. One thread writes; any thread reads.

    Args:
        path: The file; made with its table when it is missing.

    Raises:
        sqlite3.Error: The file cannot be opened, or holds something else.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._connection = sqlite3.connect(
            path, timeout=BUSY_TIMEOUT, check_same_thread=False
        )
        try:
            # With a write-ahead log, readers and the writer do not wait for each other.
            self._connection.execute("PRAGMA journal_mode = WAL")
            # The log is synchronised at its checkpoints only: a power cut may lose the
            # last events, the end of the process loses none.
            self._connection.execute("PRAGMA synchronous = NORMAL")
            with self._connection:
                self._connection.execute(_TABLE)
        except sqlite3.Error:
            self._connection.close()
            raise

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def newest_id(self) -> int:
        """Return the largest number of an event; 0 when there is none.

        Raises:
            sqlite3.Error: The file cannot be read.
        """
        found = self._connection.execute("SELECT max(id) FROM events").fetchone()[0]
        return int(found or 0)

    def append(self, events: Sequence[Event]) -> None:
        """Write all events or none; an event whose number is known is not replaced.

        Raises:
            sqlite3.Error: The events cannot be written.
        """
        with self._connection:
            self._connection.executemany(_INSERT, map(_row, events))

    def prune(self, most: int, oldest: float) -> None:
        """Delete events that are too many or too old.

        Args:
            most: Number of the newest events to keep, >= 1.
            oldest: Wall time before which events are deleted [s since 1970].

        Raises:
            sqlite3.Error: The file cannot be written.
        """
        with self._connection:
            self._connection.execute(
                "DELETE FROM events WHERE id <= (SELECT max(id) FROM events) - ?"
                " OR time < ?",
                (most, oldest),
            )

    def read(
        self,
        after: int,
        limit: int,
        kinds: Collection[EventKind] = (),
        severity: Severity = Severity.INFO,
    ) -> list[Event]:
        """Return events after a number, oldest first. Any thread; reads the disk.

        Args:
            after: Number of the last event that the reader has, >= 0.
            limit: Most events that are returned, >= 1.
            kinds: Kinds of the events; all when empty.
            severity: Least severity of the events.

        Raises:
            sqlite3.Error: The file cannot be read.
        """
        return self._select("id > ?", "ASC", (after, kinds, severity, limit))

    def read_newest(
        self,
        before: int,
        limit: int,
        kinds: Collection[EventKind] = (),
        severity: Severity = Severity.INFO,
    ) -> list[Event]:
        """Return the last events before a number, oldest first. Any thread.

        Args:
            before: Only events with smaller numbers, >= 1.
            limit: Most events that are returned, >= 1.
            kinds: Kinds of the events; all when empty.
            severity: Least severity of the events.

        Raises:
            sqlite3.Error: The file cannot be read.
        """
        chosen = self._select("id < ?", "DESC", (before, kinds, severity, limit))
        return chosen[::-1]

    def _select(
        self,
        condition: str,
        order: str,
        values: tuple[int, Collection[EventKind], Severity, int],
    ) -> list[Event]:
        number, kinds, severity, limit = values
        # A newer station may have written kinds of events that this station does not
        # know.
        names = [kind.value for kind in kinds or EventKind]
        query = (
            f"SELECT {_COLUMNS} FROM events WHERE {condition} AND severity >= ? AND "
            f"kind IN ({', '.join('?' * len(names))}) ORDER BY id {order} LIMIT ?"
        )
        given = (number, severity.rank, *names, limit)
        # Use a new connection, because the writer's one may be in the middle of a
        # batch.
        with closing(sqlite3.connect(self.path, timeout=BUSY_TIMEOUT)) as connection:
            return [_event(row) for row in connection.execute(query, given)]


def _row(event: Event) -> tuple[object, ...]:
    return (
        event.id,
        event.time,
        event.stamp,
        event.cycle,
        event.kind.value,
        event.severity.rank,
        event.who,
        event.where,
        event.what,
        event.result,
        event.text,
        written_details(event.details),
        event.request_id,
        event.boot_id,
    )


def _event(row: tuple[object, ...]) -> Event:
    identifier, time, stamp, cycle, kind, severity, *texts = row
    who, where, what, result, text, details, request_id, boot_id = map(str, texts)
    return Event(
        id=int(str(identifier)),
        time=float(str(time)),
        stamp=float(str(stamp)),
        cycle=int(str(cycle)),
        kind=EventKind(str(kind)),
        severity=_SEVERITIES[int(str(severity))],
        who=who,
        where=where,
        what=what,
        result=result,
        text=text,
        details=json.loads(details),
        request_id=request_id,
        boot_id=boot_id,
    )


@dataclass(frozen=True, slots=True)
class Origin:
    """The origin of an event.

    Attributes:
        who: Name of the token or person; empty for the station itself.
        where: Address that the request came from; empty for the station itself.
        request_id: Name of the request, as in its answer; empty without a request.
    """

    who: str = ""
    where: str = ""
    request_id: str = ""


STATION = Origin()
"""The station itself."""


def written_details(details: Mapping[str, object]) -> str:
    """Return details as JSON of at most `MAX_DETAILS` characters.

    Args:
        details: Anything; values of types that JSON does not have are written as text,
            and numbers that are not finite as null.
    """
    if not details:
        return "{}"
    # JSON has no NaN: `_plain` has replaced it by null.
    text = json.dumps(_plain(details), allow_nan=False)
    if len(text) <= MAX_DETAILS:
        return text
    return json.dumps({"shortened": text[: MAX_DETAILS // 2]})


def _plain(value: object) -> object:
    """Return a value with only the types that JSON has."""
    if isinstance(value, float):
        # The difference is 0 unless the value is NaN or infinite.
        return value if value - value == 0.0 else None
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [_plain(each) for each in value]
    if isinstance(value, Enum):
        return _plain(value.value)
    return value if value is None or isinstance(value, (bool, int)) else str(value)
