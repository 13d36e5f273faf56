"""The events of a station: kept on disk, and passed on to listeners."""

from station.events.alarms import Alarm as Alarm
from station.events.alarms import AlarmNotFoundError as AlarmNotFoundError
from station.events.alarms import Alarms as Alarms
from station.events.event import Origin as Origin
from station.events.event_log import EventLog as EventLog
from station.events.event_log import EventLogState as EventLogState
from station.reports import Event as Event
from station.reports import EventKind as EventKind
from station.reports import Severity as Severity
