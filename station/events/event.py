"""One thing that happened: when, what, who, from where, with what result."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

MAX_TEXT = 500
"""Longest text that an event keeps [characters]; the rest is cut off."""
MAX_DETAILS = 4000
"""Longest details, written as JSON [characters]; longer ones are kept as their text."""


class Severity(Enum):
    """How much an event asks for somebody's attention."""

    INFO = "info"
    """Something happened as it should."""
    WARNING = "warning"
    """Something was refused, stopped, or came too late."""
    ERROR = "error"
    """Something failed."""

    @property
    def rank(self) -> int:
        """Order among the severities: 0 for `INFO`."""
        return list(Severity).index(self)


class EventKind(Enum):
    """What an event is about."""

    STATION = "station"
    """The station starts, ends, or could not do part of its start."""
    REQUEST = "request"
    """Somebody asked for a change, which was carried out or refused."""
    LOGIN = "login"
    """A browser has logged in or out."""
    LOGIN_FAILED = "login_failed"
    """Somebody showed a token that the station does not know."""
    TOKEN = "token"
    """A named token was made, revoked, or has expired."""
    CONTROL = "control"
    """The control of the station changed hands."""
    COMMAND_STREAM = "command_stream"
    """A stream of set-points began, ended or fell silent."""
    STOP = "stop"
    """The latched stop was engaged, released or armed."""
    SWITCH = "switch"
    """A switch of controllers came to its end."""
    CONTROLLER = "controller"
    """A controller was loaded or unloaded, started or stopped."""
    FAULT = "fault"
    """A controller was stopped because of a fault."""
    ROBOT_MODE = "robot_mode"
    """The robot's mode changed, e.g. to reflex."""
    OVERRUN = "overrun"
    """Several cycles in a row came too late."""
    LOOP = "loop"
    """The control loop started, ended or died."""
    WATCHDOG = "watchdog"
    """The watchdog ended or does not look at the loop any more, or looks again."""
    RECORDING = "recording"
    """A recording began or ended."""
    INCIDENT = "incident"
    """The cycles around an incident were kept."""
    EXPERIMENT = "experiment"
    """An experiment began, came further or ended."""
    ALARM = "alarm"
    """Somebody has acknowledged an alarm."""
    EVENTS = "events"
    """The event log itself: events could not be written, or can be again."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where an event comes from.

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


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened. Nobody changes an event.

    Attributes:
        id: Number of the event, from 1, growing without gaps while the station runs.
        time: Wall time [s since 1970, UTC].
        stamp: Station time [s], >= 0.
        cycle: Number of the last cycle before the event; 0 before the first one.
        kind: What the event is about.
        severity: How much it asks for attention.
        who: Name of the token or person; empty for the station itself.
        where: Address that the request came from; empty for the station itself.
        what: Method and route, or the subject, such as a controller's name.
        result: Status and code of a refusal, or the new state, in one or two words.
        text: A sentence for people.
        details: More facts as JSON.
        request_id: Name of the request, as in its answer; empty without a request.
        boot_id: Random name of the run of the station.
    """

    id: int
    time: float
    stamp: float
    cycle: int
    kind: EventKind
    severity: Severity
    who: str = ""
    where: str = ""
    what: str = ""
    result: str = ""
    text: str = ""
    details: Mapping[str, object] = field(default_factory=dict)
    request_id: str = ""
    boot_id: str = ""


def written_details(details: Mapping[str, object]) -> str:
    """Return details as JSON of at most `MAX_DETAILS` characters.

    Args:
        details: Anything; values that JSON does not have are written as their text,
            and numbers that are not finite as null.
    """
    if not details:
        return "{}"
    text = json.dumps(_plain(details), allow_nan=False)
    if len(text) <= MAX_DETAILS:
        return text
    return json.dumps({"shortened": text[: MAX_DETAILS // 2]})


def _plain(value: object) -> object:
    """Return a value as JSON has it."""
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [_plain(each) for each in value]
    if isinstance(value, Enum):
        return _plain(value.value)
    return value if value is None or isinstance(value, (bool, int)) else str(value)
