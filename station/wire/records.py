"""Wire models of what a station keeps: recordings, incidents, events and alarms."""

from typing import Annotated, Literal

from pydantic import Field, JsonValue

from station.reports import Event
from station.wire.base import (
    FromEnum,
    Items,
    Measurements,
    Reason,
    RequestModel,
    ResponseModel,
)

RecordingId = Annotated[
    str, Field(min_length=1, max_length=120, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
]
"""The name of a recording, which is also one segment of a URL."""
RecordingStateName = Literal["recording", "stopped", "failed", "recovered"]
SeverityName = Literal["info", "warning", "error"]
EventKindName = Literal[
    "station",
    "request",
    "login",
    "login_failed",
    "token",
    "control",
    "command_stream",
    "stop",
    "switch",
    "controller",
    "fault",
    "robot_mode",
    "overrun",
    "loop",
    "watchdog",
    "recording",
    "incident",
    "experiment",
    "alarm",
    "agent",
    "events",
]


class Recording(ResponseModel):
    """A recording, or an incident that the station kept by itself.

    Attributes:
        identifier: Its name among the recordings.
        name: Name that the user gave; empty without a name.
        note: Note of the user.
        state: `recording` now; `stopped`; `failed` before its end, `error` says why;
            `recovered` after the station was killed.
        error: Reason of a failure, or what a recovery could not save; empty without
            either.
        started_at: When it began, ISO 8601.
        first_cycle: Number of its first cycle; 0 while it has none.
        last_cycle: Number of its last cycle; 0 while it has none.
        cycles: Number of cycles in it; 0 after a recovery, which does not count them.
        lost: Cycles that were overwritten before they could be recorded.
        duration: Station time from its first cycle to its last [s].
        size: Bytes of the file.
        causes: Causes of an incident; empty for a recording of a user.
        is_uploaded: Whether it was uploaded as a file instead of recorded here.

    Example:
        {"identifier": "20261122T091500123-pick", "name": "pick", "note": "With the
         heavy cube.", "state": "stopped", "error": "", "started_at":
         "2026-11-22T09:15:00+00:00", "first_cycle": 1201, "last_cycle": 61200,
         "cycles": 60000, "lost": 0, "duration": 59.999, "size": 45000000, "causes": []}
    """

    identifier: str
    name: str
    note: str
    state: RecordingStateName
    error: Reason
    started_at: str
    first_cycle: int
    last_cycle: int
    cycles: int
    lost: int
    duration: float
    size: int
    causes: Items[str] = Field(default_factory=list)
    is_uploaded: bool = False


class Recordings(ResponseModel):
    """Recordings, the oldest first.

    Attributes:
        recordings: The recordings.
    """

    recordings: Items[Recording]


class RecordingRequest(RequestModel):
    """Begin to record with the next cycle.

    Attributes:
        name: Its name: up to 80 letters, digits, `_`, `.` and `-`; it becomes a
            part of the file's name.
        note: Note to store in the recording.

    Example:
        {"name": "pick", "note": "With the heavy cube."}
    """

    name: str = Field(
        default="", max_length=80, pattern=r"^([A-Za-z0-9_][A-Za-z0-9_.-]*)?$"
    )
    note: str = Field(default="", max_length=2000)


class Trajectory(ResponseModel):
    """The joint positions of a recording, some per second.

    Attributes:
        name: Joint names, shape (n,).
        cycle: Numbers of the cycles, shape (m,).
        time: Station time of each cycle [s], shape (m,).
        position: Positions in each cycle [rad or m], shape (m, n); null where a reading
            was not finite.
    """

    name: Items[str]
    cycle: Items[int]
    time: Items[float]
    position: Items[Measurements]


class RecordedEvent(ResponseModel):
    """An event in a recording, or the note of a person.

    Attributes:
        time: Station time [s].
        kind: Kind of the event, such as `switch`; `incident` for the cause of an
            incident, `note` for a note.
        severity: `info`, `warning` or `error`.
        text: A sentence for people.
        until: Station time at which the range of a note ends [s]; null for a single
            moment.
        details: More facts, by kind; for a note, `who` is its author.

    Example:
        {"time": 12.5, "kind": "note", "severity": "info", "text": "The cube slipped.",
         "until": 13.25, "details": {"who": "ada", "until": 13.25}}
    """

    time: float
    kind: str
    severity: str
    text: str
    until: float | None
    details: dict[str, JsonValue]


class RecordedEvents(ResponseModel):
    """The events of a recording, in the order of their times.

    Attributes:
        events: The events.
    """

    events: Items[RecordedEvent]


class NoteRequest(RequestModel):
    """Add a note to a recording.

    Attributes:
        text: The note.
        time: Station time of the moment, or of the begin of the range [s].
        until: Station time of the end of the range [s]; null for a moment.

    Example:
        {"text": "The cube slipped.", "time": 12.5, "until": 13.25}
    """

    text: str = Field(min_length=1, max_length=500)
    time: float
    until: float | None = None


class Events(ResponseModel):
    """Events, oldest first.

    Attributes:
        events: The events, oldest first.
        newest_id: Number of the newest event there is, 0 without any; ask for events
            `since` the last one of this answer to get the next page.
    """

    events: Items[Event]
    newest_id: int


class EventLogState(ResponseModel):
    """State of the event log.

    Attributes:
        newest_id: Number of the newest event, 0 without any.
        pending: Events that are not on disk yet, 0 or more.
        lost: Events that this run has not been able to keep on disk, 0 or more.
        failure: Why events are not written to disk at the moment; empty while they are.
    """

    newest_id: int
    pending: int
    lost: int
    failure: Reason


class Alarm(ResponseModel):
    """A condition that needs a person, present or not yet acknowledged.

    Attributes:
        id: Number of the alarm, 1 or more; a cause that returns gets a new one.
        subject: Part in trouble: `stop`, `loop`, `events`, `robot <arm_id>` or
            `controller <name>`.
        severity: `warning`: a wanted state, such as a stop; `error`: a failure.
        text: The problem, with its cause.
        remedy: Advice to the user.
        raised_at: When it was noticed, as wall time [s since 1970, UTC].
        cleared_at: When the cause was gone, as wall time [s since 1970]; null before.
        acknowledged_by: Name of the person who has acknowledged it; empty before.
        acknowledged_at: When it was acknowledged, as wall time [s since 1970]; null
            before.

    Example:
        {"id": 3, "subject": "stop", "severity": "warning", "text": "The station is
         stopped: Stopped by operator.", "remedy": "Remove the reason, then release the
         stop and allow motion.", "raised_at": 1767225600.25, "cleared_at": null,
         "acknowledged_by": "ada", "acknowledged_at": 1767225604.5}
    """

    id: int
    subject: str
    severity: Annotated[SeverityName, FromEnum]
    text: str
    remedy: str
    raised_at: float
    cleared_at: float | None
    acknowledged_by: str
    acknowledged_at: float | None


class Alarms(ResponseModel):
    """The alarms, newest first.

    Attributes:
        alarms: Alarms whose cause is present, and alarms that nobody has acknowledged.
        unacknowledged: Number of alarms that nobody has acknowledged, 0 or more.
    """

    alarms: Items[Alarm]
    unacknowledged: int
