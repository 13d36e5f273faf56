"""Watch a station, and record changes of its state; not in the control thread."""

import logging
import threading
from collections.abc import Callable, Mapping
from types import MappingProxyType

from station.core.control.controller import ControllerCondition
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.franka.franka_robot_state import RobotMode
from station.core.loop.stop_latch import StopState
from station.events.event_log import EventLog
from station.reports import EventKind, LoopState, Severity

_log = logging.getLogger(__name__)

LOOK_PERIOD = 0.05
"""Time between two looks of the thread [s]."""
BURST = 5
"""Number of missed deadlines that are reported as a burst, if no quiet second lies
between them."""
QUIET = 1.0
"""Time without a missed deadline after which a burst is over [s]."""
FIRST_FOLD, LONGEST_FOLD = 60.0, 3600.0
"""After a reported burst, further bursts are counted for this time and then reported
together [s]. It begins with the first value and grows by factors of four up to the
second, since a machine that is too slow stays too slow."""
CALM = 600.0
"""Time without a burst after which the next burst is reported at once [s]."""
_ADVICE = (
    " Something else takes this computer's processors, often a browser that draws the "
    "3D view without a graphics processor: close it, or open the page on another "
    "computer. `station doctor` says what else helps."
)


class StateWatcher:
    """Records changes of a station's state, in a thread or at each call of `look`.

    It reads only data that any thread may read: the newest snapshot, the stop, the list
    of controllers. It may miss a state that lasts less than `LOOK_PERIOD`.

    Args:
        station: The station.
        log: Takes the events.
        also: Further checks to call at every look, by the name of the part that they
            check.
    """

    def __init__(
        self,
        station: Station,
        log: EventLog,
        also: Mapping[str, Callable[[], None]] = MappingProxyType({}),
    ) -> None:
        self._station = station
        self._log = log
        self._arms = Arms(station.robots)
        self._stop = (StopState.ARMED, "")
        self._loop = station.loop.state
        self._unwatched: str | None = None
        self._mode = ""
        self._controllers: dict[str, ControllerCondition] = {}
        self._bursts = _Bursts(log, station.loop.skipped)
        self._parts: dict[str, Callable[[], None]] = {
            "the control loop": self._look_at_loop,
            "the watchdog": self._look_at_watchdog,
            "the stop": self._look_at_stop,
            "the robot's mode": self._look_at_mode,
            "the controllers": self._look_at_controllers,
            "missed deadlines": self._look_at_deadlines,
            **also,
        }
        self._failing: set[str] = set()
        self._end = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Start the thread; its first look records the present state as new."""
        self._thread = threading.Thread(
            target=self._run, name="state-watcher", daemon=True
        )
        self._thread.start()

    def stop(self, timeout: float = 1.0) -> None:
        """Look once more and end the thread.

        Args:
            timeout: Longest wait [s].
        """
        self._end.set()
        if self._thread is not None:
            self._thread.join(timeout)
        self._bursts.tell_folded(self._station.loop.clock.now())

    def look(self) -> None:
        """Record the changes since the last look.

        A check that fails is logged and recorded once, until it succeeds again; the
        other checks still run.
        """
        for what, look in self._parts.items():
            self._station.loop.cycle_yield.wait_if_cycle_is_due()
            try:
                look()
            except Exception as error:  # noqa: BLE001 - reported; the watching goes on
                if what not in self._failing:
                    self._failing.add(what)
                    self._tell_failure(what, error)
            else:
                self._failing.discard(what)

    def _tell_failure(self, what: str, error: Exception) -> None:
        _log.exception("Changes of %s cannot be watched.", what)
        self._log.record(
            EventKind.EVENTS,
            f"Changes of {what} cannot be watched and are missing here: {error!r}.",
            severity=Severity.ERROR,
            what=what,
            result="failed",
        )

    def _run(self) -> None:
        while not self._end.wait(LOOK_PERIOD):
            self.look()
        self.look()

    def _look_at_loop(self) -> None:
        state = self._station.loop.state
        if state is self._loop:
            return
        self._loop = state
        failed = state is LoopState.FAILED
        dead = self._station.dead()
        self._log.record(
            EventKind.LOOP,
            dead or f"The control loop is {state.value}.",
            severity=Severity.ERROR if failed else Severity.INFO,
            result=state.value,
        )

    def _look_at_watchdog(self) -> None:
        failure = self._station.watchdog_failure
        if failure == self._unwatched:
            return
        self._unwatched = failure
        failed = failure is not None
        self._log.record(
            EventKind.WATCHDOG,
            failure or "The watchdog looks at the control loop again.",
            severity=Severity.ERROR if failed else Severity.INFO,
            result="failed" if failed else "watching",
        )

    def _look_at_stop(self) -> None:
        latch = self._station.loop.stop_latch
        found = (latch.state, latch.reason)
        if found == self._stop:
            return
        self._stop = found
        state, reason = found
        stopped = state is StopState.STOPPED
        text = {
            StopState.STOPPED: f"The station was stopped: {reason}",
            StopState.RELEASED: "The stop was released; motion must still be armed.",
            StopState.ARMED: "The station was armed; motion is possible.",
        }[state]
        self._log.record(
            EventKind.STOP,
            text,
            severity=Severity.WARNING if stopped else Severity.INFO,
            result=state.value,
            details={"reason": reason, "epoch": self._station.epoch},
        )

    def _look_at_mode(self) -> None:
        snapshot = self._station.snapshots.latest()
        if snapshot is None or snapshot.mode == self._mode:
            return
        before, self._mode = self._mode, snapshot.mode
        reports = self._arms.reports()
        errors = [
            f"{arm.arm_id}: {error.description}"
            for arm in reports
            if arm.robot_mode is RobotMode.REFLEX
            for error in arm.errors
        ]
        is_bad = any(bad in snapshot.mode for bad in ("reflex", "other"))
        self._log.record(
            EventKind.ROBOT_MODE,
            f"The robot's mode is {snapshot.mode}; it was {before or 'unknown'}.",
            severity=Severity.ERROR if is_bad else Severity.INFO,
            result=snapshot.mode,
            details={
                "before": before,
                "seen_in_cycle": snapshot.cycle,
                "errors": errors,
                "remedies": [
                    f"{arm.arm_id}: {arm.remedy}" for arm in reports if arm.remedy
                ],
            },
        )

    def _look_at_deadlines(self) -> None:
        loop = self._station.loop
        self._bursts.look(loop.skipped, loop.cycle, loop.clock.now())

    def _look_at_controllers(self) -> None:
        present = {status.name: status for status in self._station.manager.conditions()}
        for name, status in present.items():
            self._look_at_controller(self._controllers.get(name), status)
        for name in self._controllers.keys() - present.keys():
            text = f"Controller '{name}' was unloaded."
            self._log.record(EventKind.CONTROLLER, text, what=name, result="unloaded")
        self._controllers = present

    def _look_at_controller(
        self, before: ControllerCondition | None, status: ControllerCondition
    ) -> None:
        name, state = status.name, status.state.value
        if before is None or before.state is not status.state:
            was = "not loaded" if before is None else before.state.value
            self._log.record(
                EventKind.CONTROLLER,
                f"Controller '{name}' is {state}; it was {was}.",
                what=name,
                result=state,
                details={"type": status.type, "before": was},
            )
        if status.fault is not None and (before is None or before.fault is None):
            self._log.record(
                EventKind.FAULT,
                f"Controller '{name}' was stopped: {status.fault}",
                severity=Severity.ERROR,
                what=name,
                result=state,
                details={"traceback": status.traceback},
            )


class _Bursts:
    """Records missed deadlines that follow each other closely as one event.

    The first burst is reported with a remedy; later bursts are counted and reported
    together.
    """

    def __init__(self, log: EventLog, skipped: int) -> None:
        self._log = log
        self._seen = skipped
        self._count = 0
        self._first_cycle = 0
        self._last = 0.0
        self._is_advised = False
        self._told_at = float("-inf")
        self._fold = FIRST_FOLD
        self._folded: list[int] = []  # deadlines missed in each burst not reported yet
        self._ended_at = float("-inf")

    def look(self, skipped: int, cycle: int, now: float) -> None:
        """Count the deadlines missed since the last look; record an ended burst."""
        new, self._seen = skipped - self._seen, skipped
        if new:
            if not self._count:
                self._first_cycle = cycle
            self._count += new
            self._last = now
        elif self._count and now - self._last >= QUIET:
            self._end_burst(now)
        if self._folded and now - self._told_at >= self._fold:
            self._fold = min(4.0 * self._fold, LONGEST_FOLD)
            self.tell_folded(now)

    def _end_burst(self, now: float) -> None:
        count, self._count = self._count, 0
        if count < BURST:
            return
        is_calm = now - self._ended_at >= CALM
        self._ended_at = now
        if is_calm and not self._folded:
            self._fold = FIRST_FOLD
            advice, self._is_advised = "" if self._is_advised else _ADVICE, True
            self._tell(f"missed {count} deadlines in a burst.{advice}", [count], now)
        else:
            self._folded.append(count)

    def tell_folded(self, now: float) -> None:
        """Record the bursts that were counted since the last recorded one."""
        if not self._folded:
            return
        bursts, self._folded = self._folded, []
        times = "once more" if len(bursts) == 1 else f"in {len(bursts)} more bursts"
        since = f"within {now - self._told_at:.0f} s"
        self._tell(f"missed {sum(bursts)} deadlines {times} {since}.", bursts, now)

    def _tell(self, what: str, bursts: list[int], now: float) -> None:
        self._told_at = now
        self._log.record(
            EventKind.OVERRUN,
            f"The control loop {what}",
            severity=Severity.WARNING,
            result=str(sum(bursts)),
            details={
                "missed": sum(bursts),
                "bursts": len(bursts),
                "seen_in_cycle": self._first_cycle,
            },
        )
