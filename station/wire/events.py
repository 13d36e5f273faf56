"""Wire models of events: what happened, who did it, from where, with what result."""

from typing import Literal

from station.reports import Event
from station.wire.base import Items, Reason, ResponseModel

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
