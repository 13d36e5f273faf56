"""What happened at a station: kept on disk, told to whoever listens."""

from station.events.alarms import Alarm, AlarmNotFoundError, Alarms
from station.events.event import Origin
from station.events.event_log import EventLog, EventLogState
from station.reports import Event, EventKind, Severity

__all__ = [
    "Alarm",
    "AlarmNotFoundError",
    "Alarms",
    "Event",
    "EventKind",
    "EventLog",
    "EventLogState",
    "Origin",
    "Severity",
]
