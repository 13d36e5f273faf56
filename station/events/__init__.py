"""The events of a station: kept on disk, and passed on to listeners."""

from station.events.alarms import (
    Alarm as Alarm,
    AlarmNotFoundError as AlarmNotFoundError,
    Alarms as Alarms,
)
from station.events.event_file import Origin as Origin
from station.events.event_log import (
    EventLog as EventLog,
    EventLogState as EventLogState,
)
from station.reports import Event as Event, EventKind as EventKind, Severity as Severity
