"""Read a recording as a table, row by row, and export it as CSV, NPZ or Parquet.

A table has chosen channels, joints and cycles. However long the recording is, memory
holds only the chunks that may have messages of the present cycle.
"""

import csv
import io
import math
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, ChunkIndex
from mcap.stream_reader import get_chunk_data_stream
from numpy.typing import NDArray

from station.core.errors import RecordingDamagedError, RecordingRefusedError, suggest
from station.records.cdr import Form, MessageType
from station.records.cycle_messages import CYCLES
from station.records.mcap_scan import HEAD, MESSAGE
from station.records.messages import EVENT, STRING, TF_MESSAGE, TYPES
from station.records.recording_reader import reading

CYCLE_COLUMNS = ("cycle", "time", "period", "epoch")
"""The first columns of every table; `cycle` and `epoch` are whole numbers."""
_WITHOUT_NUMBERS = frozenset({STRING.name, EVENT.name, TF_MESSAGE.name})
_MOST_FORMS = 1000
"""Most forms of messages (texts and array lengths) that a recording may have."""
Row = tuple[float, ...]
FORMATS = ("mcap", "csv", "npz", "parquet")
Columns = dict[str, NDArray[np.float64]]
"""Columns of a table by name, shape (m,) each; whole numbers are int64."""
_WHOLE = frozenset({"cycle", "epoch"})
_ROWS = 20
"""Rows in a piece of CSV, which then takes about a millisecond to make."""


@dataclass(frozen=True, slots=True)
class Choice:
    """The selected part of a recording.

    Attributes:
        channels: Channels, or channels with a field, e.g. `joint_states` or
            `joint_states/position`; all when empty.
        joints: Names of joints or other elements; all when empty.
        rate: Rows per second of station time [Hz], > 0; every cycle when None.
    """

    channels: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    rate: float | None = None

    def has(self, column: str, element: str | None) -> bool:
        """Return whether a column is wanted.

        Args:
            column: Full name of the column.
            element: Joint whose value the column has; None for a field with one value.
        """
        if self.joints and element not in self.joints:
            return False
        wanted = (one.strip("/") for one in self.channels)
        return not self.channels or any(
            column == one or column.startswith(f"{one}/") for one in wanted
        )


@dataclass(slots=True)
class _Reading:
    """The conversion of one form of messages into the cells of a row."""

    form: Form
    read: Callable[[bytes], Row]
    places: list[int]


class RecordingTable:
    """A recording that is read as a table.

    Args:
        path: The file of the recording.
        choice: Wanted part of the recording.
        pause: Called between short pieces of work.

    Attributes:
        names: Names of the columns, made of channel, field and joint or element, e.g.
            `joint_states/position/panda_joint1`.

    Raises:
        RecordingFileError: The file cannot be read.
        RecordingDamagedError: The file is not a complete recording.
    """

    def __init__(
        self,
        path: Path,
        choice: Choice | None = None,
        pause: Callable[[], None] = lambda: None,
    ) -> None:
        self._path = path
        self._choice = choice or Choice()
        self._pause = pause
        self.names: list[str] = list(CYCLE_COLUMNS)
        self._places: dict[str, int] = {}
        self._all_names: set[str] = set()
        self._elements: set[str] = set()
        self._kinds: dict[int, MessageType] = {}
        self._topics: dict[int, str] = {}
        self._cycles: int | None = None
        self._readings: dict[int, list[_Reading]] = {}
        self._chunks: list[ChunkIndex] = []
        with reading(path) as file:
            self._look(file)

    def check(self) -> None:
        """Refuse a choice of parts that the recording does not have.

        Raises:
            RecordingRefusedError: The recording does not have a chosen channel or
                joint.
        """
        for one in self._choice.channels:
            wanted = one.strip("/")
            if not any(f"{name}/".startswith(f"{wanted}/") for name in self._all_names):
                known = sorted({n.rpartition("/")[0] for n in self._all_names})
                raise RecordingRefusedError(
                    f"The recording has no channel '{one}' with numbers.",
                    remedy=suggest(wanted, known),
                    details={"channel": one},
                )
        for joint in self._choice.joints:
            if joint not in self._elements:
                raise RecordingRefusedError(
                    f"The recording has no joint '{joint}'.",
                    remedy=suggest(joint, sorted(self._elements)),
                    details={"joint": joint},
                )

    def rows(self) -> Iterator[Row]:
        """Yield a row per cycle, NaN where a channel has no message in a cycle.

        Raises:
            RecordingDamagedError: The file has changed since it was opened.
        """
        waiting: dict[int, list[tuple[int, bytes]]] = {}
        choose = _every(self._choice.rate)
        with reading(self._path) as file:
            for chunk, limit in zip(self._chunks, self._limits(), strict=True):
                self._pause()
                for channel, stamp, data in _messages(file, chunk):
                    if channel in self._kinds:
                        waiting.setdefault(stamp, []).append((channel, data))
                for stamp in sorted(one for one in waiting if one < limit):
                    found = waiting.pop(stamp)
                    if self._has_cycle(found) and choose(stamp):
                        yield self._row(found)
                        self._pause()

    def _limits(self) -> list[float]:
        """Return the oldest time after each chunk [ns since 1970]."""
        limits, oldest = [], math.inf
        for chunk in reversed(self._chunks):
            limits.append(oldest)
            oldest = min(oldest, chunk.message_start_time)
        return limits[::-1]

    def _look(self, file: BinaryIO) -> None:
        """Find the columns of the recording.

        Raises:
            RecordingDamagedError: The file has no index.
        """
        summary = make_reader(file).get_summary()
        if summary is None:
            raise RecordingDamagedError(
                f"{self._path} lacks its index.",
                remedy="`station recover-file` writes it again.",
            )
        for number, channel in summary.channels.items():
            schema = summary.schemas.get(channel.schema_id)
            kind = None if schema is None else TYPES.get(schema.name)
            if kind is not None and kind.name not in _WITHOUT_NUMBERS:
                self._take_channel(number, channel, kind)
        # Sort by time: the chunk of a note is the last in the file but may have an
        # early time, and all rows since that time would wait for it.
        self._chunks = sorted(
            (
                one
                for one in summary.chunk_indexes
                if not one.message_index_offsets
                or not self._kinds.keys().isdisjoint(one.message_index_offsets)
            ),
            key=lambda one: one.chunk_start_offset,
        )
        for chunk in self._chunks:
            self._pause()
            for number, _, data in _messages(file, chunk):
                known = self._readings.get(number)
                if known is not None and not any(one.form.fits(data) for one in known):
                    self._add_form(number, data)

    def _take_channel(self, number: int, channel: Channel, kind: MessageType) -> None:
        if channel.topic == CYCLES:
            self._cycles = number
        self._kinds[number] = kind
        self._topics[number] = channel.topic.strip("/")
        self._readings[number] = []

    def _add_form(self, channel: int, data: bytes) -> None:
        """Keep the reader of a new form of messages.

        Raises:
            RecordingDamagedError: There are too many forms.
        """
        form = Form(self._kinds[channel], data)
        wanted, places = [], []
        for index, (field, element) in enumerate(form.names):
            if field.startswith("header/"):
                continue
            if channel == self._cycles:
                wanted.append(index)
                places.append(CYCLE_COLUMNS.index(field))
                continue
            parts = (
                self._topics[channel],
                field,
                *([] if element is None else [element]),
            )
            name = "/".join(parts)
            self._all_names.add(name)
            if element is not None:
                self._elements.add(element)
            if self._choice.has(name, element):
                if name not in self._places:
                    self._places[name] = len(self.names)
                    self.names.append(name)
                wanted.append(index)
                places.append(self._places[name])
        found = self._readings[channel]
        if sum(map(len, self._readings.values())) >= _MOST_FORMS:
            raise RecordingDamagedError(
                f"{self._path} has more than {_MOST_FORMS} forms of messages.",
                remedy="Read it with another program, such as Foxglove.",
            )
        found.append(_Reading(form, form.reader(wanted), places))

    def _has_cycle(self, messages: list[tuple[int, bytes]]) -> bool:
        return any(channel == self._cycles for channel, _ in messages)

    def _row(self, messages: list[tuple[int, bytes]]) -> Row:
        row = [math.nan] * len(self.names)
        for channel, data in messages:
            for one in self._readings[channel]:
                if one.places and one.form.fits(data):
                    for place, value in zip(one.places, one.read(data), strict=True):
                        row[place] = value
                    break
        return tuple(row)


def _every(rate: float | None) -> Callable[[int], bool]:
    """Return a filter that decides for each cycle in turn whether to keep its row."""
    if rate is None:
        return lambda _: True
    first: int | None = None
    last_due = -1.0

    def choose(stamp: int) -> bool:
        nonlocal first, last_due
        first = stamp if first is None else first
        due = math.floor((stamp - first) * 1e-9 * rate + 1e-6)
        if due <= last_due:
            return False
        last_due = due
        return True

    return choose


def _messages(file: BinaryIO, index: ChunkIndex) -> Iterator[tuple[int, int, bytes]]:
    """Yield channel, time [ns] and content of the messages of a chunk."""
    file.seek(index.chunk_start_offset + HEAD.size)
    chunk = Chunk.read(ReadDataStream(file))
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)
    records, at = stream.read(size), 0
    while at < len(records):
        opcode, length = HEAD.unpack_from(records, at)
        at += HEAD.size
        if opcode == Opcode.MESSAGE:
            channel, _, stamp, _ = MESSAGE.unpack_from(records, at)
            yield channel, stamp, records[at + MESSAGE.size : at + length]
        at += length


def columns(path: Path, topics: Iterable[str] = ()) -> Columns:
    """Return a recording as columns with one row per cycle.

    The name of a column has the channel, the field, and the joint or axis, e.g.
    `joint_states/position/panda_joint1`; `cycle`, `time`, `period` and `epoch` come
    first. Where a channel has no message in a cycle, its columns are NaN.

    Args:
        path: The file.
        topics: Channels; all when empty.

    Raises:
        RecordingFileError: The file is not a complete recording.
    """
    return _columns(RecordingTable(path, Choice(channels=tuple(topics))))


def export(path: Path, target: Path, form: str, choice: Choice | None = None) -> None:
    """Write a recording as a table.

    Args:
        path: The file of the recording.
        target: The file to write, which must not exist.
        form: `csv`, `npz` or `parquet`.
        choice: Wanted part of the recording; all when None.

    Raises:
        RecordingFileError: The file is not a complete recording.
        RecordingRefusedError: The form is unknown, or the recording does not have a
            wanted channel or joint.
        ModuleNotFoundError: Parquet needs the package pyarrow.
    """
    writers = {"csv": _write_csv, "npz": _write_npz, "parquet": _write_parquet}
    if form not in writers:
        raise RecordingRefusedError(
            f"A recording cannot be written as {form!r}.",
            remedy=f"There are: {', '.join(writers)}.",
        )
    table = RecordingTable(path, choice)
    table.check()
    writers[form](table, target)


def csv_pieces(
    path: Path, choice: Choice, pause: Callable[[], None] = lambda: None
) -> Iterator[str]:
    """Return the text of a recording as CSV, piece by piece, its header first.

    Args:
        path: The file of the recording.
        choice: Wanted part of the recording.
        pause: Called between short pieces of work.

    Raises:
        RecordingFileError: The file is not a complete recording; raised before the
            first piece.
        RecordingRefusedError: The recording does not have the wanted channels or
            joints.
    """
    table = RecordingTable(path, choice, pause)
    # Check before the first piece: a later error would truncate an answer.
    table.check()
    return _csv_pieces(table)


def _csv_pieces(table: RecordingTable) -> Iterator[str]:
    buffer = io.StringIO()
    writer = csv.writer(buffer)
    writer.writerow(table.names)
    for number, row in enumerate(table.rows(), 1):
        writer.writerow(row)
        if number % _ROWS == 0:
            yield buffer.getvalue()
            # Reuse the buffer, so that a large table needs no more memory than a piece.
            buffer.seek(0)
            buffer.truncate()
    yield buffer.getvalue()


def _columns(table: RecordingTable) -> Columns:
    cells: list[array[Any]] = [
        array("q" if name in _WHOLE else "d") for name in table.names
    ]
    for row in table.rows():
        for column, value in zip(cells, row, strict=True):
            column.append(value)
    return {
        name: np.frombuffer(column, dtype=np.int64 if name in _WHOLE else np.float64)
        if len(column)
        else np.empty(0)
        for name, column in zip(table.names, cells, strict=True)
    }


def _write_csv(table: RecordingTable, target: Path) -> None:
    # Mode `x` never overwrites an existing file.
    with target.open("x", newline="", encoding="utf-8") as file:
        file.writelines(_csv_pieces(table))


def _write_npz(table: RecordingTable, target: Path) -> None:
    arrays: Mapping[str, NDArray[np.float64]] = _columns(table)
    with target.open("xb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def _write_parquet(table: RecordingTable, target: Path) -> None:
    # Imported late: pyarrow is large, and belongs to an extra.
    import pyarrow
    from pyarrow import parquet

    arrays = _columns(table)
    with target.open("xb") as file:
        parquet.write_table(pyarrow.table(dict(arrays)), file)
