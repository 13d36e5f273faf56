"""Record every cycle from the ring of snapshots, in a thread of its own.

The thread wakes a hundred times a second and handles the new cycles, so that it holds
the interpreter for a millisecond at most. The snapshots cost the control thread no
extra work; while a recording runs, it also samples commands and arms.
"""

import json
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from station.core.errors import (
    ControllerNotFoundError,
    RecordingFileError,
    RecordingRefusedError,
)
from station.core.facade.station import Station
from station.records.cycle_messages import CycleMessages, RowPacker
from station.records.cycle_sources import sources_of
from station.records.incident_watch import IncidentWatch
from station.records.mcap_file import DiskFile, McapFile
from station.records.record_store import FAILED, RecordingInfo, RecordStore
from station.records.recording import GAINS, INPUTS, RecordedInputs, Recording

if TYPE_CHECKING:
    from station.records.recording_events import RecordedEvent

WAKE = 0.01
"""How often the thread looks at the ring [s]."""
FLUSH = 0.1
"""How often an unfinished chunk is written to the disk [s]."""
BEFORE, AFTER = 10.0, 2.0
"""Time before and after an incident whose cycles are kept [s station time]."""
INCIDENT = "incident"
"""Kind of the events that give the cause of an incident, and name of its recording."""


class Recorder:
    """Records cycles, and keeps those around an incident. Not for the control thread.

    Args:
        station: The station.
        store: Folder of the recordings.
        incidents: Folder of the incidents; None keeps none.
        texts: Texts with which every file begins, by topic.
        open_file: Function that opens a new file.
        wall_time: Returns the wall time [ns since 1970].

    Attributes:
        store: As given.
        incidents: As given.
        last: Information on the present recording, or on the last one; None before
            the first.
        failure: Why the thread ended; None while all is well.
        tell: Called with a recording or an incident when it begins, ends or fails, in
            any thread; must return at once.
    """

    def __init__(
        self,
        station: Station,
        store: RecordStore,
        incidents: RecordStore | None = None,
        *,
        texts: Mapping[str, str] | None = None,
        open_file: Callable[[Path], DiskFile] = DiskFile,
        wall_time: Callable[[], int] = time.time_ns,
    ) -> None:
        self.store = store
        self.incidents = incidents
        self.last: RecordingInfo | None = None
        self.failure: str | None = None
        self.tell: Callable[[RecordingInfo], None] = lambda _: None
        self._station = station
        self._texts = dict(texts or {})
        self._open_file = open_file
        loop = station.loop
        self._encoder = CycleMessages(wall_time() - round(loop.time * 1e9))
        self._packer = RowPacker(station.joint_names, self._elements)
        # Begin with the oldest cycle in the ring: cycles before this object count, too.
        self._cycle = 0
        self._first = 0
        # Keep one more second, because the thread may come late.
        rows = round((BEFORE + AFTER + 1.0) / loop.period)
        self._rows: deque[bytes] = deque(maxlen=rows)
        self._watch = IncidentWatch(station)
        self._causes: dict[str, float] = {}
        self._incident_end = 0.0
        self._recording: Recording | None = None
        self._inputs = RecordedInputs(station.inputs, self._write_input)
        self._events: deque[tuple[float, str, str, str, str]] = deque(maxlen=10_000)
        self._gains = ""
        self._lock = threading.Lock()
        self._end = threading.Event()
        self._thread: threading.Thread | None = None
        self._flushed = 0.0

    def start_thread(self) -> None:
        """Start the thread that reads the ring until `close`."""
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread, the running recording and the incident that is being kept."""
        self._end.set()
        if self._thread is not None:
            self._thread.join(1.0)
        self.drain()
        with self._lock:
            self._stop()
            self._keep_incident()

    def add_event(
        self, stamp: float, kind: str, severity: str, text: str, details: str
    ) -> None:
        """Record an event, if a recording runs. Any thread; never waits.

        Args:
            stamp: Station time [s].
            kind: Kind of the event.
            severity: Severity of the event.
            text: A sentence for people.
            details: More facts as JSON.
        """
        if self._recording is not None:
            self._events.append((stamp, kind, severity, text, details))

    def start(self, name: str = "", note: str = "") -> RecordingInfo:
        """Begin to record with the next cycle; one recording at a time.

        Args:
            name: Name that the user gives.
            note: Note of the user.

        Raises:
            RecordingRefusedError: A recording runs, the name is not allowed, or the
                quota is used up.
            RecordingFileError: The file cannot be made.
        """
        with self._lock:
            if self._recording is not None:
                running = self._recording.info.identifier
                raise RecordingRefusedError(
                    f"'{running}' is being recorded already.",
                    remedy="Stop it first.",
                    details={"id": running},
                )
            self.store.check_room()
            self._drain()
            recording = self._begin(self.store, name, note)
            recording.open_sources()
            # The cycles until now are not in the recording, but their inputs are.
            self._first = self._station.loop.cycle + 1
            recording.begin(self._first)
            self._gains = ""
            self._recording = recording
            self._note(recording.info)
            return recording.info

    def stop(self, identifier: str | None = None) -> RecordingInfo:
        """End the recording; return its description.

        Args:
            identifier: Id or name of the recording; the present one when None.

        Raises:
            RecordingNotFoundError: There is no such recording.
            RecordingRefusedError: The recording does not run, or several have that
                name.
        """
        with self._lock:
            present = self._recording
            # The running recording wins over older recordings of the same name.
            is_present = present is not None and identifier == present.info.name != ""
            if identifier is not None and not is_present:
                info = self.store.info(identifier)
                if present is None or info.identifier != present.info.identifier:
                    raise RecordingRefusedError(
                        f"'{identifier}' is not being recorded; it is {info.state}. "
                        f"{info.error}".strip(),
                        remedy="Only the recording that runs can be stopped.",
                        details={"id": identifier, "state": info.state},
                    )
            self._drain()
            stopped = self._stop()
            if stopped is None:
                raise RecordingRefusedError(
                    "Nothing is being recorded.", remedy="Start a recording first."
                )
            return stopped

    def end(self) -> RecordingInfo:
        """End the recording if it still runs; return the description of the last one.

        Raises:
            RecordingRefusedError: The station has not recorded anything yet.
        """
        if self._recording is not None:
            return self.stop()
        if self.last is None:
            raise RecordingRefusedError(
                "Nothing was recorded.", remedy="Start a recording first."
            )
        return self.last

    def info(self, identifier: str) -> RecordingInfo:
        """Return the present description of a recording.

        Args:
            identifier: Id of the recording, or its name if that is unique.

        Raises:
            RecordingNotFoundError: There is no such recording.
            RecordingRefusedError: Several have that name.
        """
        last = self.last
        if last is not None and last.identifier == identifier:
            return last
        found = self.store.info(identifier)
        if last is not None and last.identifier == found.identifier:
            return last
        return found

    def infos(self) -> list[RecordingInfo]:
        """Return all recordings, the oldest first."""
        last = self.last
        return [
            last if last is not None and last.identifier == one.identifier else one
            for one in self.store.infos()
        ]

    def add_note(
        self,
        store: RecordStore,
        identifier: str,
        text: str,
        begin: float,
        *,
        until: float | None = None,
        who: str = "",
    ) -> "RecordedEvent":
        """Add a note to a recording or an incident that has ended.

        Args:
            store: The store of the recordings, or of the incidents.
            identifier: Id or name of the recording.
            text: The note.
            begin: Station time of the moment, or of the begin of the range [s].
            until: Station time of the end of the range [s]; None for a moment.
            who: Author of the note.

        Raises:
            RecordingNotFoundError: There is no such recording.
            RecordingRefusedError: The recording still runs, or the note lies outside of
                its time.
            RecordingFileError: The file is not a complete recording, or cannot be
                written.
        """
        # Imported late: most runs of a station add no note.
        from station.records.recording_events import add_note

        path = store.file(identifier)
        note = add_note(path, text, begin, until, who)
        info = replace(store.info(identifier), size=path.stat().st_size)
        store.keep(info)
        if self.last is not None and self.last.identifier == identifier:
            self.last = info
        return note

    def drain(self) -> None:
        """Read the cycles since the last call from the ring, and record them."""
        with self._lock:
            self._drain()

    def _run(self) -> None:
        while not self._end.wait(WAKE):
            try:
                self.drain()
            except Exception as error:  # noqa: BLE001 - the boundary: shown in /status
                self._give_up(f"{type(error).__name__}: {error}")
                return

    def _give_up(self, why: str) -> None:
        self.failure = f"The recorder ended: {why}."
        last = self.last
        if self._recording is not None and last is not None:
            self._recording.give_up()
            self.store.keep(self._note(replace(last, state=FAILED, error=self.failure)))
            self._recording = None

    def _drain(self) -> None:
        recording = self._recording
        # Ask before reading the rows. A cycle leaves its row before its samples, so
        # each cycle has all of its messages in the recording, or none.
        until = None if recording is None else recording.newest_sampled()
        rows = self._station.snapshots.rows_since(self._cycle)
        self._inputs.take(self._cycle)
        if rows.lost:
            self._inputs.lose("what was asked while cycles were lost", self._cycle)
        for index in range(len(rows)):
            self._station.loop.cycle_yield.wait_if_cycle_is_due()
            packed = self._packer.pack(rows.record(index))
            row = self._packer.unpack(packed)
            if until is not None and row.cycle > until:
                break
            self._rows.append(packed)
            if recording is not None and row.cycle >= self._first:
                recording.add_row(row)
            periods = round(row.period / self._station.loop.period)
            self._inputs.note_periods(row.cycle, periods)
            self._note_causes(self._watch.look(row), row.time)
            self._cycle = row.cycle
        if len(rows):
            stop = self._station.loop.stop_latch.cycle
            self._note_causes(self._watch.look_at_stop(), rows.time_of(stop))
        if recording is not None:
            recording.add_samples(self._cycle, rows.lost)
            self._add_texts(recording)
            self._write_out(recording)
        if self._causes and self._station.loop.time >= self._incident_end:
            self._keep_incident()

    def _note_causes(self, causes: list[str], time_of_cycle: float) -> None:
        if not causes or self.incidents is None:
            return
        if not self._causes:
            self._incident_end = time_of_cycle + AFTER
        for cause in causes:
            self._causes.setdefault(cause, time_of_cycle)

    def _write_input(self, text: str) -> None:
        if self._recording is not None:
            self._recording.add_text(INPUTS, text, self._station.loop.time)

    def _add_texts(self, recording: Recording) -> None:
        gains = json.dumps(self._station.tuning.all_gains())
        if gains != self._gains:
            self._gains = gains
            recording.add_text(GAINS, gains, self._station.loop.time)
        while self._events:
            recording.add_event(*self._events.popleft())

    def _write_out(self, recording: Recording) -> None:
        now = time.monotonic()
        is_due = now - self._flushed >= FLUSH
        if is_due:
            self._flushed = now
        problem = recording.write_out(end_chunk=is_due)
        self.last = recording.info
        if problem is not None:
            self._note(recording.finish(problem))
            self._recording = None

    def _begin(
        self,
        store: RecordStore,
        name: str,
        note: str,
        causes: tuple[str, ...] = (),
    ) -> Recording:
        info, disk = store.begin(self._open_file, name, note, causes)
        file = McapFile(disk)
        sources = [] if causes else sources_of(self._station)
        recording = Recording(info, store, file, self._encoder, sources)
        recording.add_facts(self._station, self._texts)
        whole = {"kind": "begin", "is_whole": self._inputs.is_whole}
        for text in (json.dumps(whole), *self._inputs.texts):
            recording.add_text(INPUTS, text, self._station.loop.time)
        return recording

    def _stop(self) -> RecordingInfo | None:
        recording, self._recording = self._recording, None
        if recording is None:
            return None
        return self._note(recording.finish())

    def _note(self, info: RecordingInfo) -> RecordingInfo:
        """Make this the last recording, and call `tell` with it."""
        self.last = info
        self.tell(info)
        return info

    def _keep_incident(self) -> None:
        """Write the cycles in memory to the file of an incident."""
        causes, self._causes = self._causes, {}
        store = self.incidents
        if not causes or store is None:
            return
        begin = self._incident_end - AFTER - BEFORE
        store.drop_oldest(store.quota.count - 1)
        try:
            incident = self._begin(store, INCIDENT, "", tuple(causes))
        except RecordingFileError as error:
            self.failure = f"An incident could not be kept: {error.message}"
            return
        for packed in self._rows:
            row = self._packer.unpack(packed)
            if begin <= row.time <= self._incident_end:
                incident.add_row(row)
        for cause, time_of_cycle in causes.items():
            incident.add_event(time_of_cycle, INCIDENT, "warning", cause, "{}")
        ended = incident.finish()
        self.tell(ended)
        if ended.error:
            self.failure = f"An incident could not be kept: {ended.error}"

    def _elements(self, name: str) -> list[str]:
        try:
            return list(self._station.manager.get_controller(name).joint_names)
        except ControllerNotFoundError:
            return []  # unloaded meanwhile; its elements get numbers
