"""Wire models of events: who did what, and alarms: what asks for a person."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, JsonValue

from station.wire.base import FromEnum, Items, Reason, ResponseModel

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
    "events",
]


class Event(ResponseModel):
    """Something that happened at the station.

    Attributes:
        id: Number of the event, 1 or more; goes on growing when the station restarts.
        time: Wall time [s since 1970, UTC].
        stamp: Station time [s], 0 or more; 0 before the first cycle.
        cycle: Number of the last cycle before the event, 0 or more.
        kind: What the event is about: `request` (a change that somebody asked for),
            `login`, `login_failed`, `token`, `control`, `command_stream`, `stop`,
            `switch`, `controller` (its state), `fault` (of a controller),
            `robot_mode`, `overrun`, `loop`, `watchdog` (it ended or hangs),
            `recording`, `incident`, `experiment` (its progress), `alarm`
            (acknowledged), `station`, and `events` (the log itself).
        severity: `info`; `warning`: refused, stopped or too late; `error`: failed.
        who: Name of the token or person; empty for the station itself.
        where: Address that the request came from; empty for the station itself.
        what: Method and route, or the subject, such as a controller's name.
        result: Status and code of the answer, or the new state.
        text: A sentence for people.
        details: More facts, by kind.
        request_id: Name of the request, as in the header `X-Request-ID` of its answer;
            empty without a request.
        boot_id: Which run of the station it was.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "id": 17,
                    "time": 1767225600.25,
                    "stamp": 12.345,
                    "cycle": 12345,
                    "kind": "request",
                    "severity": "warning",
                    "who": "operator",
                    "where": "127.0.0.1",
                    "what": "POST /controllers/switch",
                    "result": "409 resource_conflict",
                    "text": "POST /controllers/switch of operator was refused: 409 "
                    "resource_conflict.",
                    "details": {},
                    "request_id": "0f4c",
                    "boot_id": "5b1e",
                }
            ]
        }
    )

    id: int
    time: float
    stamp: float
    cycle: int
    kind: Annotated[EventKindName, FromEnum]
    severity: Annotated[SeverityName, FromEnum]
    who: str = ""
    where: str = ""
    what: str = ""
    result: str = ""
    text: str = ""
    details: dict[str, JsonValue] = Field(default_factory=dict)
    request_id: str = ""
    boot_id: str = ""


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
    """Something that asks for a person, or did until a person has seen it.

    Attributes:
        id: Number of the alarm, 1 or more; a cause that returns gets a new one.
        subject: What is in trouble: `stop`, `loop`, `events`, `robot <arm_id>` or
            `controller <name>`.
        severity: `warning`: as somebody wanted, such as a stop; `error`: a failure.
        text: What is wrong, with its cause.
        remedy: What to do about it.
        raised_at: When it was noticed, as wall time [s since 1970, UTC].
        cleared_at: When the cause was gone, as wall time [s since 1970]; null before.
        acknowledged_by: Name of who has seen it; empty before.
        acknowledged_at: When that was, as wall time [s since 1970]; null before.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "id": 3,
                    "subject": "stop",
                    "severity": "warning",
                    "text": "The station is stopped: Stopped by operator.",
                    "remedy": "Remove the reason, then release the stop and allow "
                    "motion.",
                    "raised_at": 1767225600.25,
                    "cleared_at": None,
                    "acknowledged_by": "ada",
                    "acknowledged_at": 1767225604.5,
                }
            ]
        }
    )

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
        alarms: Those whose cause is there, and those that nobody has acknowledged.
        unacknowledged: How many of them nobody has acknowledged, 0 or more.
    """

    alarms: Items[Alarm]
    unacknowledged: int
