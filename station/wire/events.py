"""Wire models of events and alarms."""

from typing import Annotated, Literal

from station.reports import Event
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
    "agent",
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
