"""Write an MCAP file by foxglove-sdk, in lz4 chunks of up to 512 KiB."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import foxglove
from foxglove.mcap import MCAPCompression, MCAPWriteOptions

from station.core.user_files import try_lock
from station.records.cycle_messages import Message

if TYPE_CHECKING:
    from collections.abc import Callable

CHUNK = 524_288
"""Most bytes of a chunk before compression. A chunk is also ended ten times a second; a
Panda at 1 kHz makes 470 kB in that time."""
PROFILE = "ros2"


class DiskFile:
    """A file on the disk that is written piece by piece, and locked until it is closed.

    Attributes:
        size: Bytes on the disk.

    Args:
        path: A new file.

    Raises:
        OSError: The file exists or cannot be made.
    """

    def __init__(self, path: Path) -> None:
        # Only the user may read recordings; an existing file is never overwritten.
        self._descriptor = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
        # The lock keeps another station of this user from recovering or deleting the
        # file.
        try_lock(self._descriptor)
        self.size = 0

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Write some of the data; return the number of bytes that were written.

        Raises:
            OSError: The disk is full, or broken.
        """
        count = os.write(self._descriptor, data)
        self.size += count
        return count

    def close(self) -> None:
        """Close the file."""
        os.close(self._descriptor)


class _Buffer:
    """The file object for the SDK: memory, which cannot fail and does not wait.

    With a real file the SDK would write while it holds the interpreter lock, and after
    an error write a line to stderr for every message.
    """

    def __init__(self) -> None:
        self.data = bytearray()
        self._size = 0

    def write(self, data: bytes | bytearray) -> int:
        self.data += data
        self._size += len(data)
        return len(data)

    def seek(self, _offset: int, _whence: int = 0) -> int:
        return self._size  # the SDK only asks for the position

    def flush(self) -> None:
        return

    def take(self) -> bytearray:
        data, self.data = self.data, bytearray()
        return data


class McapFile:
    """Messages of any channels in one file; one thread at a time.

    Args:
        disk: Receives the bytes.

    Attributes:
        disk: As given.
        failure: Why nothing more is written; None while all is well.
    """

    def __init__(self, disk: DiskFile) -> None:
        self.disk = disk
        self.failure: OSError | None = None
        self._buffer = _Buffer()
        self._context = foxglove.Context()
        self._channels: dict[str, foxglove.Channel] = {}
        self._loggers: dict[str, Callable[[bytes, int], None]] = {}
        self._writer = foxglove.open_mcap(
            self._buffer,
            context=self._context,
            writer_options=MCAPWriteOptions(
                compression=MCAPCompression.Lz4,
                profile=PROFILE,
                chunk_size=CHUNK,
                disable_seeking=True,
            ),
        )

    def log(self, message: Message, stamp: int) -> None:
        """Add a message.

        Args:
            message: The message.
            stamp: Time of the message [ns since 1970].
        """
        log = self._loggers.get(message.topic)
        if log is None:
            kind = message.kind
            schema = foxglove.Schema(
                name=kind.name, encoding="ros2msg", data=kind.text.encode()
            )
            channel = foxglove.Channel(
                message.topic,
                message_encoding="cdr",
                schema=schema,
                context=self._context,
            )
            self._channels[message.topic] = channel
            # Bypass `Channel.log`, which checks the type of every message.
            log = self._loggers[message.topic] = channel.base.log
        log(message.data, stamp)

    def add_metadata(self, name: str, values: dict[str, str]) -> None:
        """Add facts about the whole file."""
        self._writer.write_metadata(name, values)

    def end_chunk(self) -> None:
        """End the present chunk, so that all messages so far can go to the disk."""
        self._writer.flush()

    def write_out(self) -> None:
        """Write complete chunks to the disk; an error goes into `failure`."""
        data = memoryview(self._buffer.take())
        # After a failed write the file has a gap. More data would only hide it.
        if self.failure is not None:
            return
        try:
            # A disk that is nearly full may take only a part.
            while data:
                data = data[self.disk.write(data) :]
        except OSError as error:
            self.failure = error

    def close(self) -> None:
        """Write the rest and the index of the file, and close it."""
        # Close the writer first: this puts the index into the buffer.
        self._writer.close()
        for channel in self._channels.values():
            channel.close()
        self.write_out()
        self.give_up()

    def give_up(self) -> None:
        """Close the file without its index."""
        try:
            self.disk.close()
        except OSError as error:
            self.failure = self.failure or error
