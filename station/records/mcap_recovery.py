"""Make a whole MCAP file of one whose end is missing.

Whoever is killed while recording leaves a file without its index, and perhaps with half
a record at its end. What is complete stays where it is; the half record is cut off, and
the index is written again from the chunks.

Source: MCAP format specification 1.0, https://mcap.dev/spec.
"""

import io
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import lz4.frame
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

from station.core.errors import RecordingFileError

MAGIC = b"\x89MCAP0\r\n"
_HEAD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQ")
"""What a message begins with: channel, number, time."""
_LARGEST = 2**31


@dataclass(frozen=True, slots=True)
class Recovered:
    """What a recovery found.

    Attributes:
        is_changed: Whether the file was cut off; a whole file is left as it is.
        messages: Number of messages in the file.
        dropped: Bytes that were cut off.
    """

    is_changed: bool
    messages: int
    dropped: int


@dataclass
class _Content:
    """What the complete records of a file hold."""

    end: int = len(MAGIC)
    is_whole: bool = False
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: list[ChunkIndex] = field(default_factory=list)
    metadata: list[MetadataIndex] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    # The messages of the last chunk, whose own indexes may be missing.
    last_chunk_end: int | None = None
    last_messages: dict[int, list[tuple[int, int]]] = field(default_factory=dict)


def recover_file(path: Path) -> Recovered:
    """Make a whole file of a truncated one, in its place.

    Args:
        path: The file.

    Raises:
        RecordingFileError: It is no MCAP file, or cannot be read or written.
    """
    try:
        with path.open("r+b") as file:
            _check_magic(path, file)
            size = file.seek(0, io.SEEK_END)
            content = _read(file, size)
            count = sum(content.counts.values())
            if content.is_whole:
                return Recovered(is_changed=False, messages=count, dropped=0)
            dropped = size - content.end
            ending = _indexes_of_last_chunk(content) + _ending(content)
            file.truncate(content.last_chunk_end or content.end)
            file.seek(0, io.SEEK_END)
            file.write(ending)
            return Recovered(is_changed=True, messages=count, dropped=dropped)
    except RecordingFileError:
        raise
    except OSError as error:
        raise RecordingFileError(
            f"{path} cannot be recovered: {error}.",
            remedy="See whether it exists, whether you may write to it, and whether "
            "the disk has room.",
        ) from error


def _check_magic(path: Path, file: BinaryIO) -> None:
    """Refuse a file that is no MCAP file.

    Raises:
        RecordingFileError: It is none.
    """
    if file.read(len(MAGIC)) != MAGIC:
        raise RecordingFileError(
            f"{path} is no recording: it does not begin as an MCAP file does.",
            remedy="Name a file that ends in .mcap and that a station wrote.",
        )


def _read(file: BinaryIO, size: int) -> _Content:
    """Read the complete records up to the first that is not, or to the end of data."""
    content = _Content()
    file.seek(content.end)
    while True:
        head = file.read(_HEAD.size)
        if len(head) < _HEAD.size:
            return content
        opcode, length = _HEAD.unpack(head)
        end = content.end + _HEAD.size + length
        if opcode == Opcode.DATA_END:
            file.seek(-len(MAGIC), io.SEEK_END)
            content.is_whole = end < size and file.read() == MAGIC
            return content
        # A chunk is followed by its indexes; a limit keeps nonsense from being read.
        if opcode == 0 or length > _LARGEST or end > size:
            return content
        _add(content, opcode, file.read(length))
        content.end = end


def _add(content: _Content, opcode: int, data: bytes) -> None:
    stream = ReadDataStream(io.BytesIO(data))
    length = _HEAD.size + len(data)
    if opcode != Opcode.MESSAGE_INDEX:
        content.last_chunk_end = None
    if opcode == Opcode.CHUNK:
        content.last_chunk_end = content.end + length
        chunk = Chunk.read(stream)
        _read_chunk(content, chunk)
        content.chunks.append(
            ChunkIndex(
                chunk_length=length,
                chunk_start_offset=content.end,
                compression=chunk.compression,
                compressed_size=len(chunk.data),
                message_end_time=chunk.message_end_time,
                message_index_length=0,
                message_index_offsets={},
                message_start_time=chunk.message_start_time,
                uncompressed_size=chunk.uncompressed_size,
            )
        )
    elif opcode == Opcode.MESSAGE_INDEX and content.chunks:
        index = MessageIndex.read(stream)
        content.chunks[-1].message_index_offsets[index.channel_id] = content.end
        content.chunks[-1].message_index_length += length
    elif opcode == Opcode.METADATA:
        name = Metadata.read(stream).name
        content.metadata.append(MetadataIndex(content.end, length, name))
    else:
        _add_description(content, opcode, data)


def _add_description(content: _Content, opcode: int, data: bytes) -> None:
    """Keep a schema or a channel."""
    stream = ReadDataStream(io.BytesIO(data))
    if opcode == Opcode.SCHEMA:
        schema = Schema.read(stream)
        content.schemas[schema.id] = schema
    elif opcode == Opcode.CHANNEL:
        channel = Channel.read(stream)
        content.channels[channel.id] = channel


def _read_chunk(content: _Content, chunk: Chunk) -> None:
    data = chunk.data
    if chunk.compression == "lz4":
        data = lz4.frame.decompress(data)
    content.last_messages = {}
    at = 0
    while at < len(data):
        opcode, length = _HEAD.unpack_from(data, at)
        begin, at = at, at + _HEAD.size
        if opcode == Opcode.MESSAGE:
            channel, _, stamp = _MESSAGE.unpack_from(data, at)
            content.last_messages.setdefault(channel, []).append((stamp, begin))
            content.counts[channel] = content.counts.get(channel, 0) + 1
        else:
            _add_description(content, opcode, data[at : at + length])
        at += length


def _indexes_of_last_chunk(content: _Content) -> bytes:
    """Return the indexes that follow the last chunk, and note where they will be."""
    if content.last_chunk_end is None:
        return b""
    data, last = b"", content.chunks[-1]
    last.message_index_offsets.clear()
    for channel, entries in content.last_messages.items():
        builder = RecordBuilder()
        MessageIndex(channel_id=channel, records=entries).write(builder)
        last.message_index_offsets[channel] = content.last_chunk_end + len(data)
        data += _bytes(builder)
    last.message_index_length = len(data)
    content.end = content.last_chunk_end + len(data)
    return data


def _ending(content: _Content) -> bytes:
    """Return the end of the data, the index of the file, and the footer."""
    builder = RecordBuilder()
    DataEnd(0).write(builder)
    summary = content.end + builder.count
    for schema in content.schemas.values():
        schema.write(builder)
    for channel in content.channels.values():
        channel.write(builder)
    for chunk in content.chunks:
        chunk.write(builder)
    for metadata in content.metadata:
        metadata.write(builder)
    Statistics(
        attachment_count=0,
        channel_count=len(content.channels),
        channel_message_counts=content.counts,
        chunk_count=len(content.chunks),
        message_count=sum(content.counts.values()),
        message_end_time=max((c.message_end_time for c in content.chunks), default=0),
        message_start_time=min(
            (c.message_start_time for c in content.chunks), default=0
        ),
        metadata_count=len(content.metadata),
        schema_count=len(content.schemas),
    ).write(builder)
    Footer(summary_crc=0, summary_offset_start=0, summary_start=summary).write(builder)
    return _bytes(builder) + MAGIC


def _bytes(builder: RecordBuilder) -> bytes:
    built: bytes = builder.end()  # type: ignore[no-untyped-call]  # mcap has no type here
    return built
