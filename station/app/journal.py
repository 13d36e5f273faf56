"""The event log of a running station, and the watcher that fills it."""

import json
from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Self

from fastapi import FastAPI

import station as package
from station.api.named_tokens import NamedTokens
from station.core.facade.station import Station
from station.events import Event, EventKind, EventLog, Severity
from station.events.state_watcher import StateWatcher
from station.local.private_files import StateDirectory, StateDirectoryError
from station.trials.background_experiments import RunState

if TYPE_CHECKING:
    from pathlib import Path

    from station.api.services import Services
    from station.records.record_store import RecordingInfo
    from station.records.recorder import Recorder

FILE = "events.sqlite"
TOKENS = "tokens.json"


class Journal:
    """Opens the event log of a station, follows the station, and closes the log.

    A station whose state directory cannot be used still runs, keeps its events in
    memory only, and warns.

    Args:
        station: The station.
        warn: Called with a line about a problem.

    Attributes:
        log: The event log.
        directory: Folder of files that outlive the station; None if it cannot be used.
    """

    def __init__(self, station: Station, warn: Callable[[str], None]) -> None:
        self._station = station
        self._stack = ExitStack()
        self.directory: Path | None = None
        try:
            self.directory = self._stack.enter_context(StateDirectory()).path
        except StateDirectoryError as error:
            warn(f"Events are kept in memory alone: {error} {error.remedy}")
        loop = station.loop
        self.log = EventLog(
            None if self.directory is None else self.directory / FILE,
            boot_id=station.boot_id,
            station_time=lambda: (loop.time, loop.cycle),
        )
        self._stack.callback(self.log.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def named_tokens(self) -> NamedTokens:
        """Return the named tokens that the station keeps in its directory.

        Raises:
            TokensNotKeptError: Their file cannot be read.
        """
        directory = self.directory
        return NamedTokens(None if directory is None else directory / TOKENS)

    def start(self, app: FastAPI) -> None:
        """Record the start and follow the station until the end.

        Args:
            app: The application; its counts of repeated requests are recorded, too.
        """
        services: Services = app.state.services
        recorder = services.event_recorder
        robot = self._station.status().robot_type
        self.log.record(
            EventKind.STATION,
            f"Station {package.__version__} with {robot} has started.",
            result="started",
            details={"version": package.__version__, "robot_type": robot},
        )
        self._stack.callback(
            self.log.record,
            EventKind.STATION,
            "The station ends in order.",
            result="ended",
        )
        self._stack.callback(recorder.repeats.finish)
        if services.recorder is not None:
            self._exchange(services.recorder)
        if services.experiments is not None:
            services.experiments.tell = self._follow_experiments()
        also = {
            "repeated requests": recorder.repeats.flush,
            "control": services.control.look,
            "alarms": services.alarms.look,
        }
        watcher = StateWatcher(self._station, self.log, also)
        watcher.start()
        self._stack.callback(watcher.stop)

    def _exchange(self, recorder: "Recorder") -> None:
        """Copy events into recordings, and log the begin and end of recordings."""

        def add(event: Event) -> None:
            kind, severity = event.kind.value, event.severity.value
            details = json.dumps(event.details)
            recorder.add_event(event.stamp, kind, severity, event.text, details)

        self._stack.callback(self.log.listen(add))
        recorder.tell = self._tell_of_recording
        self._stack.callback(setattr, recorder, "tell", lambda _: None)

    def _tell_of_recording(self, info: "RecordingInfo") -> None:
        is_incident = bool(info.causes)
        what = "Incident" if is_incident else "Recording"
        text = f"{what} {info.identifier}: {info.state}."
        if is_incident:
            causes = "; ".join(cause.rstrip(".") for cause in info.causes)
            text = f"The cycles around an incident were kept: {causes}."
        if info.error:
            text = f"{what} {info.identifier} failed: {info.error}"
        self.log.record(
            EventKind.INCIDENT if is_incident else EventKind.RECORDING,
            text,
            severity=Severity.ERROR if info.error else Severity.INFO,
            what=info.identifier,
            result=info.state,
            details={"cycles": info.cycles, "lost": info.lost, "size": info.size},
        )

    def _follow_experiments(self) -> Callable[[RunState], None]:
        """Return a callback that records at most 100 steps of an experiment."""
        last = RunState("", "")

        def tell(state: RunState) -> None:
            nonlocal last
            is_same = (state.name, state.state) == (last.name, last.state)
            step = max(1, state.total // 100)
            if is_same and state.ended - last.ended < step:
                return
            last = state
            text = f"Experiment {state.name}: {state.state}"
            if state.ended:
                text += f", {state.ended} of at most {state.total} trials"
            text += f". {state.reason}" if state.reason else "."
            is_bad = state.state == "failed"
            self.log.record(
                EventKind.EXPERIMENT,
                text,
                severity=Severity.ERROR if is_bad else Severity.INFO,
                what=state.name,
                result=state.state,
                details={
                    "ended": state.ended,
                    "total": state.total,
                    "failed": state.failed,
                },
            )

        return tell
