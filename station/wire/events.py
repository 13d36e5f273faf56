"""Wire models of events: what happened, who did it, from where, with what result."""

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
    """How the event log is doing.

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
