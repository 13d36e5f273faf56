"""Repair an MCAP file whose end is missing, or that has damaged bytes.

A killed recorder leaves a file without its index, and perhaps with half a record at its
end, which is cut off. Damaged bytes before the end are overwritten by a record that
every reader skips, so that the sound records before and after stay in their places. The
index is written again from the chunks.
"""

import fcntl
import io
import os
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, DataEnd, Footer, Header, MessageIndex, Statistics

from station.core.errors import RecordingFileError, RecordingRefusedError, counted
from station.core.user_files import open_regular
from station.records.mcap_scan import HEAD, MAGIC, Chunk, Content, McapScan, Span
from station.records.messages import CYCLE

if TYPE_CHECKING:
    from station.records.cdr import Values

_SKIPPED = 0x80
"""Opcode of a record that readers skip."""
_CYCLES = "/cycles"
_PROFILE = "ros2"
_NEAR = 10_000_000_000
"""Longest plausible time between a chunk and the next one [ns]."""


@dataclass(frozen=True, slots=True)
class Loss:
    """An interval of time whose messages are lost.

    Attributes:
        begin: Wall time of its beginning [ns since 1970]; None for the beginning of the
            recording.
        end: Wall time of its end [ns since 1970]; None for the end of the recording.
    """

    begin: int | None
    end: int | None


@dataclass(frozen=True, slots=True)
class Recovered:
    """The findings of a recovery.

    Attributes:
        is_changed: Whether the file was changed; a sound file is not.
        messages: Number of messages in the file.
        dropped: Number of damaged bytes that were removed.
        losses: Intervals whose messages are lost, besides the end of the file.
        lost_messages: Number of messages lost in these intervals; None if it is
            unknown.
        began: Wall time of the first message [ns since 1970]; 0 without one.
        cycles: Number of cycles in the file.
        first_cycle: Its first cycle; 0 without one.
        last_cycle: Its last cycle; 0 without one.
        duration: Station time from its first cycle to its last [s].
    """

    is_changed: bool
    messages: int
    dropped: int
    losses: tuple[Loss, ...] = ()
    lost_messages: int | None = 0
    began: int = 0
    cycles: int = 0
    first_cycle: int = 0
    last_cycle: int = 0
    duration: float = 0.0

    @property
    def lost_cycles(self) -> int:
        """Return the number of missing cycles between the first and the last."""
        between = self.last_cycle - self.first_cycle + 1
        # Cycles have consecutive numbers, so the number of missing ones is known.
        return max(0, between - self.cycles) if self.cycles else 0

    def text(self) -> str:
        """Return a description of the loss, in sentences; empty if nothing was lost."""
        sentences = []
        if self.losses:
            times = ", ".join(self._in_words(loss) for loss in self.losses)
            if self.lost_messages is None:
                count = "An unknown number of messages"
            else:
                count = counted(self.lost_messages, "message")
            sentences.append(f"{count} are lost: {times}.")
        if self.dropped:
            dropped = f"{self.dropped} bytes were cut off, which were not whole."
            sentences.append(dropped)
        elif self.is_changed:
            sentences.append("No message is lost; the index was written again.")
        return " ".join(sentences)

    def _in_words(self, loss: Loss) -> str:
        def clock_time(stamp: int) -> str:
            at = datetime.fromtimestamp(stamp / 1e9, UTC)
            return f"{(stamp - self.began) / 1e9:.3f} s ({at:%H:%M:%S.%f} UTC)"

        if loss.begin is None and loss.end is None:
            return "everything"
        if loss.begin is None:
            return f"all before {clock_time(loss.end or 0)}"
        if loss.end is None:
            return f"all after {clock_time(loss.begin)}"
        return f"between {clock_time(loss.begin)} and {clock_time(loss.end)}"


def recover_file(path: Path, pause: Callable[[], None] = lambda: None) -> Recovered:
    """Repair a truncated or damaged file in place.

    Args:
        path: The file.
        pause: Called between short pieces of work.

    Raises:
        RecordingFileError: The file is not an MCAP file, or cannot be read or written.
        RecordingRefusedError: A station is writing it.
    """
    try:
        with os.fdopen(open_regular(path, os.O_RDWR), "r+b") as file:
            lock(path, file)
            # Check before the scan: a file that is not a recording must not be changed.
            has_magic = _check_magic(path, file)
            content = McapScan(file, pause).run()
            if content.is_whole and has_magic:
                return _found(content, dropped=0, is_changed=False)
            size = file.seek(0, io.SEEK_END)
            dropped = sum(span.end - span.begin for span in content.spans)
            if not content.has_end:
                dropped += size - content.end
            _mend(file, content)
            return _found(content, dropped, is_changed=True)
    except RecordingFileError:
        raise
    except OSError as error:
        raise RecordingFileError(
            f"{path} cannot be recovered: {error}.",
            remedy="See whether it exists, whether you may write to it, and whether "
            "the disk has room.",
        ) from error


def lock(path: Path, file: BinaryIO) -> None:
    """Lock a file; refuse one that a station is writing.

    Raises:
        RecordingRefusedError: A station writes it.
    """
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise RecordingRefusedError(
            f"{path} is being recorded by a station.",
            remedy="Stop the recording: its file is whole then.",
        ) from error


def _check_magic(path: Path, file: BinaryIO) -> bool:
    """Refuse a file that is not MCAP; return whether its first bytes are intact.

    Raises:
        RecordingFileError: The file is no MCAP file.
    """
    begin = file.read(len(MAGIC) + HEAD.size)
    if begin.startswith(MAGIC):
        return True
    # A damaged byte leaves the other bytes of the magic, and the header after it.
    same = sum(one == other for one, other in zip(begin, MAGIC, strict=False))
    if same >= len(MAGIC) - 1 and begin[len(MAGIC) :][:1] == bytes((Opcode.HEADER,)):
        return False
    raise RecordingFileError(
        f"{path} is no recording: it does not begin as an MCAP file does.",
        remedy="Name a file that ends in .mcap and that a station wrote.",
    )


def _mend(file: BinaryIO, content: Content) -> None:
    """Overwrite damaged parts, and write the end of the file again."""
    file.seek(0)
    file.write(MAGIC)
    for span in content.spans:
        wanted = [_header()] if span.begin == len(MAGIC) else []
        _fill(file, span.begin, span.end, [*wanted, *_descriptions(content)])
    _name_channels(content)
    tail = b""
    for place, (begin, end) in content.missing_indexes.items():
        chunk = content.chunks[place]
        if begin == content.end:
            tail = indexes(chunk, begin)
        else:
            room = end - begin
            data = indexes(chunk, begin)
            _fill(file, begin, end, [data])
            if not (len(data) == room or len(data) <= room - HEAD.size):
                chunk.index.message_index_offsets.clear()
                chunk.index.message_index_length = 0
    # A new index replaces everything after the last sound record.
    file.truncate(content.end)
    file.seek(0, io.SEEK_END)
    file.write(tail)
    file.write(ending(content, content.end + len(tail)))


def _fill(file: BinaryIO, begin: int, end: int, wanted: list[bytes]) -> None:
    """Fill a span with as many of these records as fit, and one that readers skip."""
    data = b""
    for record in wanted:
        left = end - begin - len(data) - len(record)
        # The rest of the span becomes a record to skip, which needs room for its head.
        if left == 0 or left >= HEAD.size:
            data += record
    left = end - begin - len(data)
    if left:
        data += HEAD.pack(_SKIPPED, left - HEAD.size) + bytes(left - HEAD.size)
    file.seek(begin)
    file.write(data)


def _header() -> bytes:
    builder = RecordBuilder()
    Header(profile=_PROFILE, library="").write(builder)
    return built(builder)


def _descriptions(content: Content) -> list[bytes]:
    """Return the records of all schemas and channels.

    A damaged chunk may have held the only copy of some of them.
    """
    found = []
    for record in (*content.schemas.values(), *content.channels.values()):
        builder = RecordBuilder()
        record.write(builder)
        found.append(built(builder))
    return found


def _name_channels(content: Content) -> None:
    """Give a name to each channel whose description or schema is lost."""
    for number in {*content.counts, *content.channels}:
        known = content.channels.get(number)
        if known is None or known.schema_id not in {0, *content.schemas}:
            content.channels[number] = Channel(
                id=number,
                topic=known.topic if known else f"/unknown/{number}",
                message_encoding="" if known is None else known.message_encoding,
                metadata={},
                schema_id=0,
            )


def indexes(chunk: Chunk, begin: int) -> bytes:
    """Return the indexes to write after a chunk, and note their offsets in it."""
    data = b""
    for channel, entries in chunk.entries.items():
        builder = RecordBuilder()
        MessageIndex(channel_id=channel, records=entries).write(builder)
        chunk.index.message_index_offsets[channel] = begin + len(data)
        data += built(builder)
    chunk.index.message_index_length = len(data)
    return data


def ending(content: Content, begin: int) -> bytes:
    """Return the end of the data, the index of the file, and the footer."""
    builder = RecordBuilder()
    DataEnd(0).write(builder)
    data_end = built(builder)
    summary = begin + len(data_end)
    builder = RecordBuilder()
    for record in (*content.schemas.values(), *content.channels.values()):
        record.write(builder)
    indexes = [chunk.index for chunk in content.chunks]
    for index in (*indexes, *content.metadata):
        index.write(builder)
    Statistics(
        attachment_count=0,
        channel_count=len(content.channels),
        channel_message_counts=content.counts,
        chunk_count=len(indexes),
        message_count=sum(content.counts.values()),
        message_end_time=max((one.message_end_time for one in indexes), default=0),
        message_start_time=min((one.message_start_time for one in indexes), default=0),
        metadata_count=len(content.metadata),
        schema_count=len(content.schemas),
    ).write(builder)
    body = built(builder)
    builder = RecordBuilder()
    Footer(summary_crc=0, summary_offset_start=0, summary_start=summary).write(builder)
    # The checksum covers the footer up to itself.
    footer = built(builder)[:-4]
    checksum = zlib.crc32(body + footer).to_bytes(4, "little")
    return data_end + body + footer + checksum + MAGIC


def _found(content: Content, dropped: int, *, is_changed: bool) -> Recovered:
    """Return the findings in a file."""
    spans = [span for span in content.spans if span.has_messages]
    cycles = next(
        (n for n, one in content.channels.items() if one.topic == _CYCLES), None
    )
    count = 0 if cycles is None else content.counts.get(cycles, 0)
    first: Values = {"cycle": 0, "time": 0.0}
    last = first
    if cycles is not None and count:
        first = CYCLE.decode(content.first_of[cycles])
        last = CYCLE.decode(content.last_of[cycles])
    return Recovered(
        is_changed=is_changed,
        messages=sum(content.counts.values()),
        dropped=dropped,
        losses=tuple(_loss(content, span) for span in spans),
        lost_messages=_lost_messages(content, spans),
        began=min((c.index.message_start_time for c in content.chunks), default=0),
        cycles=count,
        first_cycle=first["cycle"],
        last_cycle=last["cycle"],
        duration=last["time"] - first["time"],
    )


def _loss(content: Content, span: Span) -> Loss:
    after = [c for c in content.chunks if c.index.chunk_start_offset >= span.end]
    begin = span.before.index.message_end_time if span.before else None
    end = after[0].index.message_start_time if after else None
    near = begin or end
    if span.times is not None and near is not None:
        first, last = span.times
        # The times in the head of a damaged chunk may be damaged, too.
        if first <= last and max(abs(first - near), abs(last - near)) < _NEAR:
            return Loss(first, last)
    if begin is not None and end is not None:
        # Chunks overlap: commands come later than the cycles that they belong to.
        return Loss(min(begin, end), max(begin, end))
    return Loss(begin, end)


def _lost_messages(content: Content, spans: list[Span]) -> int | None:
    """Return the number of messages in damaged chunks; None if it is unknown."""
    if not spans:
        return 0
    kept = sum(content.counts.values())
    if content.statistics is not None:
        return max(0, content.statistics.message_count - kept)
    # The messages of a channel are numbered from 1.
    missing = sum(
        max(0, content.numbers[channel] - count)
        for channel, count in content.counts.items()
    )
    return max(missing, sum(span.count for span in spans)) or None


def built(builder: RecordBuilder) -> bytes:
    """Return the records that the builder holds, and empty it."""
    data: bytes = builder.end()  # type: ignore[no-untyped-call]  # mcap has no type here
    return data
