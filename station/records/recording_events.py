"""The events of a finished recording, and the notes of people.

A note is an event like the others, so that every program that opens the file shows it.
It is stored in a new chunk after the others, and the index is written again.
"""

import io
import json
import os
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.records import Channel, Chunk as McapChunk, ChunkIndex, Message, Schema

from station.core.errors import (
    RecordingDamagedError,
    RecordingFileError,
    RecordingRefusedError,
)
from station.core.user_files import open_regular
from station.records.cdr import Values
from station.records.cycle_messages import CYCLES
from station.records.mcap_recovery import built, ending, indexes, lock
from station.records.mcap_scan import DAMAGE, MAGIC, Chunk, Content
from station.records.messages import EVENT, header
from station.records.recording import EVENTS
from station.records.recording_reader import read_messages

NOTE = "note"
"""Kind of the events that people add."""
_DATA_END_SIZE = 13
"""Size of the record that ends the data [bytes]; the index begins behind the record."""
_ENDING_SIZE = 20 + len(MAGIC)
"""Size of the footer's content and the magic [bytes]; it begins with the offset of the
index."""


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An event in a recording.

    Attributes:
        time: Station time [s].
        kind: Kind of the event, such as `request`; `note` for a note.
        severity: `info`, `warning` or `error`.
        text: A sentence for people.
        until: Station time at which the range of a note ends [s]; None for a moment.
        details: More facts, by kind; for a note, `who` is its author.
    """

    time: float
    kind: str
    severity: str
    text: str
    until: float | None = None
    details: dict[str, object] = field(default_factory=dict)


def read_events(path: Path) -> list[RecordedEvent]:
    """Return the events of a recording, in the order of their times.

    Args:
        path: The file.

    Raises:
        RecordingFileError: The file is not a complete recording.
    """
    origin = _span(path)[0]
    found = [_event(values, origin) for _, values in read_messages(path, [EVENTS])]
    return sorted(found, key=lambda event: event.time)


def add_note(
    path: Path, text: str, begin: float, until: float | None = None, who: str = ""
) -> RecordedEvent:
    """Add a note to a recording that has ended, and return the note.

    Args:
        path: The file.
        text: The note.
        begin: Station time of the moment, or of the begin of the range [s].
        until: Station time of the end of the range [s]; None for a moment.
        who: Author of the note.

    Raises:
        RecordingRefusedError: The range lies outside of the recording, or another
            process writes or repairs the file.
        RecordingFileError: The file is not a complete recording, or cannot be written.
        OSError: Never: it becomes a `RecordingFileError`.
    """
    origin, first, last = _span(path)
    end = begin if until is None else until
    if not first <= begin <= end <= last:
        raise RecordingRefusedError(
            f"The recording goes from {first:g} s to {last:g} s of station time; a "
            f"note cannot lie at {begin:g} s to {end:g} s.",
            remedy="Give a begin and an end in that range, the begin first.",
            details={"first": first, "last": last},
        )
    details: dict[str, object] = {"who": who}
    if until is not None:
        details["until"] = until
    stamp = origin + round(begin * 1e9)
    data = EVENT.encode({
        "header": header(stamp),
        "kind": NOTE,
        "severity": "info",
        "text": text,
        "details": json.dumps(details),
    })
    try:
        with os.fdopen(open_regular(path, os.O_RDWR), "r+b") as file:
            lock(path, file)
            _append(path, file, data, stamp)
    except OSError as error:
        raise RecordingFileError(
            f"{path} cannot be written: {error.strerror or error}.",
            remedy="See whether the disk has room and who may write to it.",
        ) from error
    return RecordedEvent(begin, NOTE, "info", text, until, details)


def _span(path: Path) -> tuple[int, float, float]:
    """Return the wall time of time zero [ns], and the first and last station time [s].

    Raises:
        RecordingDamagedError: The recording has no cycle.
    """
    first = next(read_messages(path, [CYCLES]), None)
    last = next(read_messages(path, [CYCLES], is_reverse=True), None)
    if first is None or last is None:
        raise RecordingDamagedError(
            f"{path} has no cycle.", remedy="Record for longer."
        )
    begin = first[1]["time"]
    return _stamp(first[1]) - round(begin * 1e9), begin, last[1]["time"]


def _stamp(message: Values) -> int:
    stamp = message["header"]["stamp"]
    return int(stamp["sec"]) * 1_000_000_000 + int(stamp["nanosec"])


def _event(message: Values, origin: int) -> RecordedEvent:
    try:
        details = json.loads(message["details"])
    except ValueError:
        details = None
    # Files of other programs may have other details.
    details = details if isinstance(details, dict) else {"text": message["details"]}
    until = details.get("until")
    return RecordedEvent(
        (_stamp(message) - origin) * 1e-9,
        message["kind"],
        message["severity"],
        message["text"],
        float(until) if isinstance(until, int | float) else None,
        details,
    )


def _append(path: Path, file: BinaryIO, data: bytes, stamp: int) -> None:
    """Write an event after the data of a file, and the index after the event.

    Raises:
        RecordingDamagedError: The file has no index.
    """
    try:
        summary = make_reader(file).get_summary()
    except DAMAGE:
        summary = None
    if summary is None or summary.statistics is None:
        raise RecordingDamagedError(
            f"{path} lacks its index.", remedy="`station recover-file` writes it again."
        )
    content = Content(
        schemas=dict(summary.schemas),
        channels=dict(summary.channels),
        metadata=list(summary.metadata_indexes),
        counts=dict(summary.statistics.channel_message_counts),
        chunks=[Chunk(index, {}, 0) for index in summary.chunk_indexes],
    )
    file.seek(-_ENDING_SIZE, io.SEEK_END)
    at = int.from_bytes(file.read(8), "little") - _DATA_END_SIZE
    chunk, written = _chunk(content, data, stamp, at)
    content.chunks.append(chunk)
    written += indexes(chunk, at + len(written))
    # Overwrite the old end in a single write: a file that is cut off in it can be
    # recovered, and loses only the note.
    file.seek(at)
    file.write(written + ending(content, at + len(written)))
    file.truncate()


def _chunk(content: Content, data: bytes, stamp: int, at: int) -> tuple[Chunk, bytes]:
    """Return a chunk with an event, and its bytes; note its channel in `content`."""
    number = next(
        (n for n, one in content.channels.items() if one.topic == EVENTS), None
    )
    if number is None:
        number = max(content.channels, default=0) + 1
        schema = max(content.schemas, default=0) + 1
        content.schemas[schema] = Schema(
            id=schema, name=EVENT.name, encoding="ros2msg", data=EVENT.text.encode()
        )
        content.channels[number] = Channel(
            id=number,
            topic=EVENTS,
            message_encoding="cdr",
            metadata={},
            schema_id=schema,
        )
    content.counts[number] = content.counts.get(number, 0) + 1
    builder = RecordBuilder()
    # A reader that does not use the index needs schema and channel before the message.
    content.schemas[content.channels[number].schema_id].write(builder)
    content.channels[number].write(builder)
    place = builder.count
    Message(
        channel_id=number,
        sequence=content.counts[number],
        log_time=stamp,
        publish_time=stamp,
        data=data,
    ).write(builder)
    records = built(builder)
    builder = RecordBuilder()
    McapChunk(
        compression="",
        data=records,
        message_end_time=stamp,
        message_start_time=stamp,
        uncompressed_crc=zlib.crc32(records),
        uncompressed_size=len(records),
    ).write(builder)
    written = built(builder)
    index = ChunkIndex(
        chunk_length=len(written),
        chunk_start_offset=at,
        compression="",
        compressed_size=len(records),
        message_end_time=stamp,
        message_index_length=0,
        message_index_offsets={},
        message_start_time=stamp,
        uncompressed_size=len(records),
    )
    return Chunk(index, {number: [(stamp, place)]}, at + len(written)), written
