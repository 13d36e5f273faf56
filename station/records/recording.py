"""A running recording: its file, its channels, its progress, and the station's inputs.

A recording has the inputs since the station's first cycle.
"""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from station.core.facade.input_log import Input, InputLog
from station.core.facade.station import Station
from station.records import messages
from station.records.cycle_messages import CycleMessages, Message, Row
from station.records.cycle_sources import Source
from station.records.mcap_file import McapFile
from station.records.record_store import FAILED, STOPPED, RecordingInfo, RecordStore

EVENTS, GAINS, INPUTS = "/events", "/gains", "/inputs"
CONFIGURATION, ROBOT_DESCRIPTION = "/configuration", "/robot_description"
MOST_INPUTS = 100_000
"""Most inputs since the station's start that a recording can have."""
_MOST_PENDING = 100


class Recording:
    """Writes one recording. Only one thread at a time may use it.

    Args:
        info: Information on the recording so far.
        store: Folder of the recording.
        file: Its file.
        encoder: Makes messages.
        sources: Samples besides the snapshots; empty for an incident.

    Attributes:
        info: Information on the recording now.
    """

    def __init__(
        self,
        info: RecordingInfo,
        store: RecordStore,
        file: McapFile,
        encoder: CycleMessages,
        sources: Iterable[Source] = (),
    ) -> None:
        self.info = info
        self._store = store
        self._file = file
        self._encoder = encoder
        self._sources = list(sources)
        self._first: Row | None = None
        self._last: Row | None = None
        self._count = 0
        self._lost = 0
        # Size of all other recordings; computed once, because it reads the folder.
        self._others = store.usage()

    def open_sources(self) -> None:
        """Sample from the next cycle on."""
        for source in self._sources:
            source.open()

    def begin(self, cycle: int) -> None:
        """Take no samples of cycles before this one.

        Args:
            cycle: Number of the first cycle of the recording.
        """
        for source in self._sources:
            source.begin(cycle)

    def newest_sampled(self) -> int | None:
        """Return the last cycle that all sources have sampled; None without sources."""
        return min((source.newest for source in self._sources), default=None)

    def add_facts(self, station: Station, texts: dict[str, str]) -> None:
        """Add the facts about the whole recording that a reader needs.

        Args:
            station: The station.
            texts: Text by topic: the configuration, the robot's description.
        """
        loop = station.loop
        self._file.add_metadata(
            "control_station",
            {
                "id": self.info.identifier,
                "name": self.info.name,
                "note": self.info.note,
                "boot_id": station.boot_id,
                "period": repr(loop.period),
                "origin": str(self._encoder.origin),
                "causes": "\n".join(self.info.causes),
            },
        )
        for topic, text in texts.items():
            self.add_text(topic, text, loop.time)

    def add_text(self, topic: str, text: str, time: float) -> None:
        """Add a text at a station time [s]."""
        self._log(self._encoder.of_text(topic, text), time)

    def add_event(
        self, stamp: float, kind: str, severity: str, text: str, details: str
    ) -> None:
        """Add an event at a station time [s]; its details are JSON."""
        event = messages.EVENT.encode({
            "header": messages.header(self._encoder.stamp(stamp)),
            "kind": kind,
            "severity": severity,
            "text": text,
            "details": details,
        })
        self._log(Message(EVENTS, messages.EVENT, event), stamp)

    def add_row(self, row: Row) -> None:
        """Add a cycle."""
        for message in self._encoder.of_row(row):
            self._log(message, row.time)
        if self._first is None:
            self._first = row
        self._last = row
        self._count += 1

    def add_samples(self, until: int, lost: int = 0) -> None:
        """Add the samples of the sources since the last call.

        Args:
            until: Number of the last cycle that is in the recording.
            lost: Number of cycles that were lost from the ring.
        """
        # A cycle that several channels lack counts as one lost cycle.
        losses = [s.take(self._encoder, self._log, until) for s in self._sources]
        self._lost += max(lost, *losses, 0)

    def write_out(self, *, end_chunk: bool) -> str | None:
        """Write to the disk; return why the recording cannot go on, None if it can.

        Args:
            end_chunk: Whether to end and write the present chunk, too.
        """
        if end_chunk:
            self._file.end_chunk()
        self._file.write_out()
        self._describe()
        if self._file.failure is not None:
            return f"The file cannot be written: {self._file.failure}."
        quota = self._store.quota.bytes
        if self._others + self.info.size > quota:
            return (
                f"The recordings together are larger than the quota of {quota} bytes."
            )
        for source in self._sources:
            if source.failure is not None:
                return f"A cycle cannot be sampled: {source.failure}."
        return None

    def finish(self, error: str | None = None) -> RecordingInfo:
        """End the recording and return its description.

        Args:
            error: Why it failed; None for a regular end.
        """
        for source in self._sources:
            source.close()
        self._file.close()
        if error is None and self._file.failure is not None:
            error = f"The file cannot be written: {self._file.failure}."
        state = STOPPED if error is None else FAILED
        self._describe()
        self.info = replace(self.info, state=state, error=error)
        failure = self._store.keep(self.info)
        if failure is not None:
            text = f"Its description cannot be written: {failure}."
            error = text if error is None else f"{error} {text}"
            self.info = replace(self.info, state=FAILED, error=error)
        return self.info

    def give_up(self) -> None:
        """Close the unfinished file, which a recovery can complete."""
        for source in self._sources:
            source.close()
        self._file.give_up()

    def _describe(self) -> None:
        """Bring `info` up to date."""
        first, last = self._first, self._last
        self.info = replace(
            self.info, size=self._file.disk.size, lost=self._lost, cycles=self._count
        )
        if first is not None and last is not None:
            self.info = replace(
                self.info,
                first_cycle=first.cycle,
                last_cycle=last.cycle,
                duration=last.time - first.time,
            )

    def _log(self, message: Message, time: float) -> None:
        self._file.log(message, self._encoder.stamp(time))


class RecordedInputs:
    """Keeps the inputs of a station as texts, each as soon as its cycle is known.

    Args:
        inputs: The station's record of its inputs.
        write: Called with each new text.

    Attributes:
        texts: The inputs so far, JSON.
        is_whole: Whether these are all inputs since the station's first cycle.
    """

    def __init__(self, inputs: InputLog, write: Callable[[str], None]) -> None:
        self.texts: list[str] = []
        self.is_whole = inputs.is_complete
        self._log = inputs
        self._write = write
        self._pending: list[Input] = []
        self._in_force: dict[str, Input] = {}

    def take(self, cycle: int) -> None:
        """Write the inputs of the station whose cycles are known by now.

        Args:
            cycle: The last cycle that the recorder has read.
        """
        self._note_expiries(list(self._in_force))
        self._pending += self._log.take_inputs()
        left = []
        for one in self._pending:
            after = one.after()
            if after is None:
                left.append(one)
                continue
            self._add({"after": after, "kind": one.kind, **_plain(one.arguments)})
            if one.kind == "set_point":
                name = str(one.arguments["name"])
                self._note_expiries([name])
                self._in_force[name] = one
        if not self._log.is_complete:
            self.lose("inputs that came faster than they could be kept", cycle)
        # Set-points that newer ones have replaced never get a cycle, so bound their
        # number.
        self._pending = left[-_MOST_PENDING:]

    def note_periods(self, cycle: int, periods: int) -> None:
        """Note a late cycle, which a re-run repeats, or a cycle that it cannot repeat.

        Args:
            cycle: Its number.
            periods: How many nominal periods have passed since the cycle before.
        """
        if periods == 1:
            return
        if periods:
            self._add({"after": cycle - 1, "kind": "late", "periods": periods})
        else:
            what = "a cycle while time stood still"
            self._add({"after": cycle - 1, "kind": "operation", "what": what})

    def lose(self, what: str, cycle: int) -> None:
        """Note once that the inputs are incomplete.

        Args:
            what: What is unknown, for the message.
            cycle: The last cycle that the recorder has read.
        """
        if self.is_whole:
            self.is_whole = False
            lost = {"after": cycle, "kind": "operation", "what": what}
            self._write(json.dumps(lost))

    def _add(self, values: dict[str, object]) -> None:
        text = json.dumps(values)
        if len(self.texts) < MOST_INPUTS:
            self.texts.append(text)
        else:
            self.lose(f"more than {MOST_INPUTS} inputs", int(str(values["after"])))
        self._write(text)

    def _note_expiries(self, names: Iterable[str]) -> None:
        """Note the controllers in `names` whose set-point has expired."""
        for name in names:
            one = self._in_force.get(name)
            until = None if one is None else one.until()
            if until is not None:
                del self._in_force[name]
                self._add({"after": until, "kind": "expire", "name": name})


def _plain(arguments: Mapping[str, object]) -> dict[str, object]:
    """Return arguments with only the types that JSON has; other values become text."""
    plain: dict[str, object] = json.loads(json.dumps(arguments, default=str))
    return plain
