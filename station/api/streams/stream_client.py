"""One client of a channel: gets each frame as soon as its connection takes it."""

import asyncio
from collections.abc import Callable
from typing import Protocol

from station.api.streams.channel import Channel, FramesLostError
from station.api.streams.frames import Frame


class StreamPort(Protocol):
    """The connection of a client, without a task or a queue between."""

    def write_frame(self, wire: bytes) -> None:
        """Hand a whole WebSocket frame to the connection."""

    def is_writable(self) -> bool:
        """Return whether the connection takes more bytes."""

    def listen(self, resumed: Callable[[], None] | None) -> None:
        """Call `resumed` whenever the connection takes more again."""

    def abort(self, code: int, reason: str) -> None:
        """Close with a code, even if the client reads nothing."""


class StreamClient:
    """Hands the frames of a channel to a connection. For one event loop.

    A client whose connection takes nothing misses frames, or with every cycle asked
    for, gets larger batches later.

    Args:
        port: The client's connection.
        channel: Source of the frames.
        slow_after: How long the connection may take nothing [s].
    """

    def __init__(self, port: StreamPort, channel: Channel, slow_after: float) -> None:
        self._port = port
        self._channel = channel
        self._slow_after = slow_after
        self._loop = asyncio.get_running_loop()
        self._seq: int | None = None
        self._blocked: asyncio.TimerHandle | None = None
        self._end: asyncio.Future[None] = self._loop.create_future()

    async def serve(self, hello: Frame) -> None:
        """Send `hello`, then frames; return when the client takes none for too long.

        The channel must have announced its ticks to the client, so that it samples.

        Args:
            hello: The first frame; its number is the one after which frames follow.

        Raises:
            RuntimeError: The channel broke down; its cause says why.
        """
        self._port.listen(self._resumed)
        try:
            self._write(hello)
            self.ticked()
            await self._end
        finally:
            self._port.listen(None)
            self._unblock()

    def ticked(self) -> None:
        """Write the next frame, if there is one and the connection takes it."""
        if self._seq is None or self._blocked is not None or self._end.done():
            return
        try:
            frame = self._channel.take(self._seq)
        except FramesLostError:
            self._too_slow()
            return
        if frame is None:
            return
        self._write(frame)
        if self._blocked is None and frame.seq < self._channel.newest:
            # Batches that were missed; other clients get their turn in between.
            self._loop.call_soon(self.ticked)

    def failed(self, error: BaseException) -> None:
        """End with the error of the channel."""
        if not self._end.done():
            broken = RuntimeError(f"{self._channel.request.topic} broke down")
            broken.__cause__ = error
            self._end.set_exception(broken)

    def _write(self, frame: Frame) -> None:
        self._seq = frame.seq
        self._port.write_frame(frame.wire)
        if not self._port.is_writable():
            self._blocked = self._loop.call_later(self._slow_after, self._too_slow)

    def _resumed(self) -> None:
        self._unblock()
        self.ticked()

    def _unblock(self) -> None:
        if self._blocked is not None:
            self._blocked.cancel()
            self._blocked = None

    def _too_slow(self) -> None:
        if not self._end.done():
            self._end.set_result(None)
