"""Alarms: conditions that need a person, kept until they are over and acknowledged.

An alarm stays in the list until its cause is gone and a person has acknowledged it, in
either order, as in ISA-18.2. Acknowledging only notes that a person has seen the alarm:
it ends no cause and moves no robot.
"""

import threading
from collections.abc import Iterator
from dataclasses import dataclass, replace

from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.franka.franka_robot_state import RobotMode
from station.core.loop.stop_latch import StopState
from station.events.event_file import STATION, Origin
from station.events.event_log import EventLog
from station.reports import EventKind, Severity

MAX_ALARMS = 200
"""Most alarms that are kept; beyond it, the oldest ones whose cause is gone are
deleted."""


class AlarmNotFoundError(StationError, KeyError):
    """There is no alarm of that number, or it is over."""

    code = "alarm_not_found"


@dataclass(frozen=True, slots=True)
class Cause:
    """A present condition that needs a person.

    Attributes:
        subject: Part in trouble, e.g. `stop`, `robot panda` or `controller joint_7`.
        severity: `ERROR` for a failure, `WARNING` for a wanted state, such as a stop.
        text: The problem, a sentence for people.
        remedy: Advice to the user, in full sentences.
    """

    subject: str
    severity: Severity
    text: str
    remedy: str


@dataclass(frozen=True, slots=True)
class Alarm:
    """A cause with the times of its begin and end, and its acknowledgement.

    Attributes:
        id: Number of the alarm, from 1; a cause that returns gets a new one.
        cause: The condition that needs a person.
        raised_at: Wall time at which it was noticed [s since 1970, UTC].
        cleared_at: Wall time at which the cause was gone [s since 1970]; None before.
        acknowledged_by: Name of the person who has acknowledged it; empty before.
        acknowledged_at: When it was acknowledged, as wall time [s since 1970]; None
            before.
    """

    id: int
    cause: Cause
    raised_at: float
    cleared_at: float | None = None
    acknowledged_by: str = ""
    acknowledged_at: float | None = None


class Alarms:
    """The alarms of a run of the station. Any thread but the control thread.

    Args:
        station: Station whose state is watched.
        log: Takes the acknowledgements, and gives the wall time. The begin and end of
            causes are events that others record.
    """

    def __init__(self, station: Station, log: EventLog) -> None:
        self._station = station
        self._log = log
        self._arms = Arms(station.robots)
        self._lock = threading.Lock()
        self._alarms: dict[int, Alarm] = {}
        self._newest = 0

    def look(self) -> None:
        """Compare the station with the list: raise new alarms, clear ended ones."""
        now = self._log.wall_time()
        with self._lock:
            # One alarm a subject: a cause that changes its text is the same alarm.
            causes = {cause.subject: cause for cause in self._causes()}
            for alarm in list(self._alarms.values()):
                if alarm.cleared_at is not None:
                    continue
                cause = causes.get(alarm.cause.subject)
                if cause == alarm.cause:
                    del causes[cause.subject]
                # Nobody has acknowledged the old text, so the new text replaces it.
                elif cause is not None and alarm.acknowledged_at is None:
                    self._keep(replace(alarm, cause=causes.pop(cause.subject)))
                else:
                    # The person acknowledged another cause, so this one is a new alarm.
                    self._keep(replace(alarm, cleared_at=now))
            for cause in causes.values():
                self._newest += 1
                self._alarms[self._newest] = Alarm(self._newest, cause, now)
            # Only after new alarms were added, so that old ones are deleted before new
            # ones.
            self._bound()

    def all(self) -> list[Alarm]:
        """Compare the station with the list, and return the alarms, newest first."""
        self.look()
        with self._lock:
            return list(self._alarms.values())[::-1]

    def acknowledge(self, number: int, origin: Origin = STATION) -> Alarm:
        """Note that a person has seen an alarm; return the alarm.

        A second acknowledgement changes nothing: the first name and time stay.

        Args:
            number: Number of the alarm.
            origin: Person who has seen it.

        Raises:
            AlarmNotFoundError: There is no such alarm, or it is over.
        """
        with self._lock:
            alarm = self._alarms.get(number)
            if alarm is None:
                raise AlarmNotFoundError(
                    f"There is no alarm {number}.",
                    remedy="GET /alarms lists the alarms there are. One that was "
                    "acknowledged leaves when its cause is gone, and one that returns "
                    "has a new number.",
                )
            # The first person stays on record.
            if alarm.acknowledged_at is not None:
                return alarm
            alarm = replace(
                alarm,
                acknowledged_by=origin.who or "station",
                acknowledged_at=self._log.wall_time(),
            )
            self._keep(alarm)
        self._log.record(
            EventKind.ALARM,
            f"Alarm {number} was acknowledged: {alarm.cause.text}",
            what=alarm.cause.subject,
            result="acknowledged",
            details={"alarm": number, "raised_at": alarm.raised_at},
            origin=origin,
        )
        return alarm

    def _keep(self, alarm: Alarm) -> None:
        """Put a changed alarm into the list, or remove it if it is over."""
        self._alarms[alarm.id] = alarm
        # The alarm is over and acknowledged: from now on only the event log has it.
        if alarm.cleared_at is not None and alarm.acknowledged_at is not None:
            del self._alarms[alarm.id]

    def _bound(self) -> None:
        gone = [each.id for each in self._alarms.values() if each.cleared_at]
        for number in gone[: max(0, len(self._alarms) - MAX_ALARMS)]:
            del self._alarms[number]

    def _causes(self) -> Iterator[Cause]:
        dead = self._station.dead()
        if dead is not None:
            yield Cause("loop", Severity.ERROR, dead, "Restart the station.")
        unwatched = self._station.watchdog_failure
        if unwatched is not None:
            yield Cause(
                "watchdog",
                Severity.ERROR,
                unwatched,
                "The station starts it anew. Until then a loop that hangs is not "
                "noticed: keep the emergency stop at hand.",
            )
        latch = self._station.loop.stop_latch
        if latch.state is StopState.STOPPED:
            yield Cause(
                "stop",
                Severity.WARNING,
                f"The station is stopped: {latch.reason}",
                "Remove the reason, then release the stop and allow motion.",
            )
        yield from self._causes_of_arms()
        for status in self._station.manager.conditions():
            if status.fault is not None:
                yield Cause(
                    f"controller {status.name}",
                    Severity.ERROR,
                    f"Controller '{status.name}' was stopped: {status.fault}",
                    "Correct what the fault names, then start the controller again, "
                    "or unload it.",
                )
        failure = self._log.state().failure
        if failure is not None:
            yield Cause(
                "events",
                Severity.ERROR,
                f"Events are kept in memory alone: {failure}",
                "Free the disk or give the station its directory; events are then "
                "written by themselves.",
            )

    def _causes_of_arms(self) -> Iterator[Cause]:
        for arm in self._arms.reports():
            if arm.remedy is None:
                continue
            errors = ", ".join(error.description for error in arm.errors)
            mode = arm.robot_mode.name.lower()
            yield Cause(
                f"robot {arm.arm_id}",
                Severity.ERROR
                if arm.robot_mode is RobotMode.REFLEX
                else Severity.WARNING,
                f"{arm.arm_id} is in mode {mode}{f': {errors}' if errors else ''}.",
                arm.remedy,
            )
