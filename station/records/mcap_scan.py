"""Read an MCAP file record by record, and find its damaged parts.

The checksum of each chunk tells whether its messages are as they were written. After a
damaged record the scan goes on at the next sound record: at the end that the damaged
record names, or else at the next chunk that the scan finds.

Source: MCAP format specification 1.0, https://mcap.dev/spec.
"""

import io
import re
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import BinaryIO

import lz4.frame
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    ChunkIndex,
    Footer,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

MAGIC = b"\x89MCAP0\r\n"
HEAD = struct.Struct("<BQ")
"""Head of a record: opcode, length."""
_CHUNK = struct.Struct("<QQQI")
"""Head of a chunk: first and last time, size, checksum."""
MESSAGE = struct.Struct("<HIQQ")
"""Head of a message: channel, number, time, time of publishing."""
_CHUNK_HEAD = re.compile(
    rb"\x06.{4}\0{4}.{28}(?:\x03\0\0\0lz4|\x04\0\0\0zstd|\0{4})", re.DOTALL
)
_END_OF_DATA = bytes((Opcode.DATA_END, 4, 0, 0, 0, 0, 0, 0, 0))
_BLOCK = 2**20
_LARGEST = 2**28
"""Largest plausible record [bytes]; records of a station have 0.5 MB at most."""
_OWN_OPCODES = 0x80
"""First of the opcodes that any program may use for itself."""
DAMAGE = (
    McapError, RuntimeError, ValueError, LookupError, OverflowError, struct.error,
)  # fmt: skip
"""Errors that the readers of lz4, MCAP and CDR raise for damaged bytes."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """A sound chunk.

    Attributes:
        index: Its entry in the index of the file, yet without the offsets of its
            message indexes.
        entries: Time [ns since 1970] and place of its messages by channel, as
            `MessageIndex` has them.
        end: Offset of the first byte after the chunk.
    """

    index: ChunkIndex
    entries: dict[int, list[tuple[int, int]]]
    end: int


@dataclass(frozen=True, slots=True)
class Span:
    """A range of bytes of a file in which some are damaged.

    Attributes:
        begin: Offset of the first byte.
        end: Offset of the first byte after the range.
        before: The last sound chunk before the range; None without one.
        has_messages: Whether messages may have been in the range.
        count: Number of messages in the range by the message indexes in it; 0 if
            unknown.
        times: First and last time [ns since 1970] in the head of a damaged chunk, which
            may be wrong; None without a chunk.
    """

    begin: int
    end: int
    before: Chunk | None
    has_messages: bool
    count: int
    times: tuple[int, int] | None


@dataclass
class Content:
    """The content of a file.

    Attributes:
        end: Offset of the first byte after the last sound record of the data.
        is_whole: Whether data and index are as they were written.
        has_end: Whether the file has the record that ends the data.
        spans: Damaged parts before `end`.
        chunks: The sound chunks.
        missing_indexes: Byte ranges for the message indexes of chunks that lack some,
            by index in `chunks`.
        schemas: Schemas by number.
        channels: Channels by number.
        metadata: Facts about the file.
        counts: Number of messages by channel.
        numbers: Sequence number of the last message, by channel; the first message has
            1.
        statistics: Counts in the file's index, if the file has one.
        first_of: The first message of each channel.
        last_of: The last message of each channel.
    """

    end: int = len(MAGIC)
    is_whole: bool = False
    has_end: bool = False
    spans: list[Span] = field(default_factory=list)
    chunks: list[Chunk] = field(default_factory=list)
    missing_indexes: dict[int, tuple[int, int]] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: list[MetadataIndex] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    numbers: dict[int, int] = field(default_factory=dict)
    statistics: Statistics | None = None
    first_of: dict[int, bytes] = field(default_factory=dict)
    last_of: dict[int, bytes] = field(default_factory=dict)


class McapScan:
    """Reads one file.

    Args:
        file: The file, opened for reading; it should begin with `MAGIC`.
        pause: Called before each record, so that the control loop of the same process
            stays on time.
    """

    def __init__(self, file: BinaryIO, pause: Callable[[], None]) -> None:
        self._file = file
        self._pause = pause
        self._size = file.seek(0, io.SEEK_END)
        self._checksum = zlib.crc32(MAGIC)
        self._content = Content()

    def run(self) -> Content:
        """Return the content of the file."""
        content, at = self._content, len(MAGIC)
        while at < self._size:
            self._pause()
            end = self._take(at)
            if end is None:
                end = self._next_whole(at)
                if end == self._size:
                    break  # no sound record follows
                self._damage(at, end)
            at = content.end = end
            if content.has_end:
                self._take_ending(at)
                break
        return content

    def _take(self, at: int) -> int | None:
        """Read a record; return the offset of its end, None when it is damaged."""
        body = self._body(at)
        if body is None:
            return None
        opcode, data = body
        try:
            end = self._take_body(at, opcode, data)
        except DAMAGE:
            return None
        if end is not None and opcode != Opcode.DATA_END:
            self._checksum = zlib.crc32(self._read(at, end - at), self._checksum)
        return end

    def _take_body(self, at: int, opcode: int, data: bytes) -> int | None:
        content, end = self._content, at + HEAD.size + len(data)
        stream = ReadDataStream(io.BytesIO(data))
        if opcode == Opcode.CHUNK:
            return self._take_chunk(at, data)
        if opcode == Opcode.METADATA:
            record = Metadata.read(stream)
            content.metadata.append(MetadataIndex(at, end - at, record.name))
        elif opcode == Opcode.DATA_END:
            (checksum,) = struct.unpack("<I", data)
            content.has_end = True
            # The checksum 0 means that the writer has not computed it.
            is_as_written = checksum in {0, self._checksum}
            is_damaged = content.spans or content.missing_indexes
            content.is_whole = is_as_written and not is_damaged
            return at
        elif opcode in {Opcode.SCHEMA, Opcode.CHANNEL}:
            self._describe(opcode, data)
        elif opcode < _OWN_OPCODES and opcode not in _ALONE:
            return None
        return end

    def _take_chunk(self, at: int, data: bytes) -> int | None:
        begin, last, size, checksum = _CHUNK.unpack_from(data)
        name_at = _CHUNK.size
        (length,) = struct.unpack_from("<I", data, name_at)
        compression = data[name_at + 4 : name_at + 4 + length].decode()
        held_at = name_at + 4 + length
        (held,) = struct.unpack_from("<Q", data, held_at)
        records = data[held_at + 8 :]
        # A station writes these compressions only.
        if held != len(records) or compression not in {"", "lz4"}:
            return None
        if compression:
            # A damaged chunk may announce, or expand to, any number of bytes.
            decompressor = lz4.frame.LZ4FrameDecompressor()
            most = min(size, _LARGEST) + 1
            records = decompressor.decompress(records, max_length=most)
        if len(records) != size or checksum not in {0, zlib.crc32(records)}:
            return None
        entries = self._messages_of(records)
        end = at + HEAD.size + len(data)
        index = ChunkIndex(
            chunk_length=end - at,
            chunk_start_offset=at,
            compression=compression,
            compressed_size=held,
            message_end_time=last,
            message_index_length=0,
            message_index_offsets={},
            message_start_time=begin,
            uncompressed_size=size,
        )
        chunk = Chunk(index, entries, end)
        self._content.chunks.append(chunk)
        return self._take_indexes(chunk)

    def _messages_of(self, records: bytes) -> dict[int, list[tuple[int, int]]]:
        """Return the positions of a chunk's messages, and keep their descriptions."""
        content, at = self._content, 0
        entries: dict[int, list[tuple[int, int]]] = {}
        last: dict[int, tuple[int, int, int]] = {}
        while at < len(records):
            opcode, length = HEAD.unpack_from(records, at)
            begin, at = at, at + HEAD.size
            if opcode == Opcode.MESSAGE:
                channel, number, stamp, _ = MESSAGE.unpack_from(records, at)
                entries.setdefault(channel, []).append((stamp, begin))
                last[channel] = (number, at, at + length)
                # The first and the last message of a channel tell the length of the
                # recording, without another pass.
                if channel not in content.first_of:
                    content.first_of[channel] = _message(records, at, at + length)
            else:
                self._describe(opcode, records[at : at + length])
            at += length
        for channel, (number, begin, end) in last.items():
            content.numbers[channel] = number
            content.last_of[channel] = _message(records, begin, end)
            count = content.counts.get(channel, 0)
            content.counts[channel] = count + len(entries[channel])
        return entries

    def _take_indexes(self, chunk: Chunk) -> int:
        """Read the indexes after a chunk; return the offset of their end."""
        end, offsets = chunk.end, chunk.index.message_index_offsets
        while len(offsets) < len(chunk.entries):
            body = self._body(end)
            index = None if body is None else _index(*body)
            if index is None or chunk.entries.get(index.channel_id) != index.records:
                break
            offsets[index.channel_id] = end
            end += HEAD.size + (0 if body is None else len(body[1]))
        chunk.index.message_index_length = end - chunk.end
        if len(offsets) < len(chunk.entries):
            # The recovery writes the indexes again, if there is room.
            offsets.clear()
            end = self._next_whole(chunk.end)
            place = len(self._content.chunks) - 1
            self._content.missing_indexes[place] = (chunk.end, end)
            return chunk.end if end == self._size else end
        return end

    def _describe(self, opcode: int, data: bytes) -> None:
        """Keep a schema or a channel."""
        stream = ReadDataStream(io.BytesIO(data))
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            self._content.schemas.setdefault(schema.id, schema)
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            self._content.channels.setdefault(channel.id, channel)

    def _damage(self, begin: int, end: int) -> None:
        """Note that the bytes from `begin` to `end` are damaged."""
        before = self._content.chunks[-1] if self._content.chunks else None
        opcode = self._read(begin, 1)[0]
        head = self._read(begin + HEAD.size, _CHUNK.size)
        is_chunk = opcode == Opcode.CHUNK and len(head) == _CHUNK.size
        times = _CHUNK.unpack(head)[:2] if is_chunk else None
        count, at = 0, begin
        while at < end and (body := self._body(at)) is not None:
            index = _index(*body)
            count += 0 if index is None else len(index.records)
            at += HEAD.size + len(body[1])
        is_small = opcode in {Opcode.HEADER, Opcode.METADATA} and at == end
        self._content.spans.append(Span(begin, end, before, not is_small, count, times))

    def _take_ending(self, at: int) -> None:
        """Read the end of the data and the index of the file."""
        content = self._content
        summary = self._read(at, self._size - at)
        content.is_whole &= _ending_is_whole(at, summary)
        position = 0
        while position + HEAD.size <= len(summary):
            opcode, length = HEAD.unpack_from(summary, position)
            position += HEAD.size
            data = summary[position : position + length]
            position += length
            try:
                # The index also describes the channels of a damaged chunk.
                self._describe(opcode, data)
                if opcode == Opcode.STATISTICS:
                    stream = ReadDataStream(io.BytesIO(data))
                    content.statistics = Statistics.read(stream)
            except DAMAGE:
                return

    def _next_whole(self, at: int) -> int:
        """Return the offset of the next sound record; the file's size without one."""
        body = self._body(at)
        if body is not None:
            end = at + HEAD.size + len(body[1])
            if self._is_plausible(end):
                # The message indexes after a damaged chunk are dropped with the chunk.
                while (body := self._body(end)) and body[0] == Opcode.MESSAGE_INDEX:
                    end += HEAD.size + len(body[1])
                if end == self._size or self._is_plausible(end):
                    return end
        return self._search(at + 1)

    def _search(self, at: int) -> int:
        """Return the start of the next chunk, or of the end of the data."""
        # The overlap is longer than a match, so that a head across two blocks is found.
        overlap = 64
        while at < self._size:
            self._pause()
            block = self._read(at, _BLOCK + overlap)
            found = [one.start() for one in _CHUNK_HEAD.finditer(block)]
            ending = block.find(_END_OF_DATA)
            for place in sorted([*found, *([ending] if ending >= 0 else [])]):
                if self._is_plausible(at + place):
                    return at + place
            at += _BLOCK
        return self._size

    def _is_plausible(self, at: int) -> bool:
        """Return whether a record may begin at an offset."""
        head = self._head(at)
        if head is None:
            return False
        opcode, length = head
        if opcode == Opcode.CHUNK:
            begin = self._read(at + HEAD.size, _CHUNK.size + 64)
            (name,) = struct.unpack_from("<I", begin, _CHUNK.size)
            held_at = _CHUNK.size + 4 + name
            if held_at + 8 > len(begin):
                return False
            (held,) = struct.unpack_from("<Q", begin, held_at)
            return bool(held_at + 8 + held == length)
        return opcode in _KINDS or opcode >= _OWN_OPCODES

    def _body(self, at: int) -> tuple[int, bytes] | None:
        """Return opcode and content of a record; None if the bytes cannot be one."""
        head = self._head(at)
        if head is None:
            return None
        opcode, length = head
        return opcode, self._read(at + HEAD.size, length)

    def _head(self, at: int) -> tuple[int, int] | None:
        """Return opcode and length of a record; None if the bytes cannot be one."""
        head = self._read(at, HEAD.size)
        if len(head) < HEAD.size:
            return None
        opcode, length = HEAD.unpack(head)
        # A damaged length must not make the scan read more than the file has.
        if opcode == 0 or length > min(_LARGEST, self._size - at - HEAD.size):
            return None
        if opcode == Opcode.CHUNK and length < _CHUNK.size + 12:
            return None
        return opcode, length

    def _read(self, at: int, length: int) -> bytes:
        self._file.seek(at)
        return self._file.read(length)


_ALONE = frozenset({
    Opcode.HEADER,
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.ATTACHMENT,
})
_KINDS = _ALONE | {
    Opcode.CHUNK,
    Opcode.MESSAGE_INDEX,
    Opcode.METADATA,
    Opcode.DATA_END,
}
"""Opcodes of the records that the data of a file with chunks has."""


def _message(records: bytes, begin: int, end: int) -> bytes:
    return records[begin + MESSAGE.size : end]


def _index(opcode: int, data: bytes) -> MessageIndex | None:
    """Return the message index in a record; None for other records."""
    if opcode != Opcode.MESSAGE_INDEX:
        return None
    try:
        index: MessageIndex = MessageIndex.read(ReadDataStream(io.BytesIO(data)))
    except DAMAGE:
        return None
    return index


def _ending_is_whole(at: int, ending: bytes) -> bool:
    """Return whether the end of the data, the index and the footer are whole.

    Args:
        at: Offset of the end of the data.
        ending: All bytes from that offset on.
    """
    size = HEAD.size + 20
    if len(ending) < size + len(MAGIC) or not ending.endswith(MAGIC):
        return False
    footer_at = len(ending) - len(MAGIC) - size
    opcode, length = HEAD.unpack_from(ending, footer_at)
    if (opcode, length) != (Opcode.FOOTER, 20):
        return False
    stream = ReadDataStream(io.BytesIO(ending[footer_at + HEAD.size :]))
    footer = Footer.read(stream)
    begin = footer.summary_start - at
    if not footer.summary_start or not 0 < begin <= footer_at:
        return False
    checked = ending[begin : footer_at + HEAD.size + 16]
    return footer.summary_crc in {0, zlib.crc32(checked)}
