"""A client of a channel, which gets each frame as soon as its connection is ready."""

import asyncio
from collections.abc import Callable
from typing import Protocol

from station.api.streams.channel import Channel, FramesLostError
from station.api.streams.frames import Frame


class StreamPort(Protocol):
    """The connection of a client, written to without a task or queue in between."""

    def write_frame(self, wire: bytes) -> None:
        """Write a whole WebSocket frame to the connection."""

    def is_writable(self) -> bool:
        """Return whether the connection accepts more bytes."""

    def listen(self, resumed: Callable[[], None] | None) -> None:
        """Call `resumed` whenever the connection accepts bytes again; None ends it."""

    def abort(self, code: int, reason: str) -> None:
        """Close with a code, even if the client does not read."""


class StreamClient:
    """Writes the frames of a channel to a connection. Use it in one event loop only.

    A client whose connection is full misses frames; if it wants every cycle, it gets
    larger batches later.

    Args:
        port: The client's connection.
        channel: Source of the frames.
        slow_after: Longest time for which the connection may be full [s].
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
        """Send `hello`, then frames; return if the client reads none for too long.

        The client must have joined the channel before, so that the channel samples.

        Args:
            hello: The first frame; further frames come after its number.

        Raises:
            RuntimeError: The channel has failed; the cause has the reason.
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
        """Write the next frame, if there is one and the connection is ready."""
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
            # Go on with missed batches later, so that other clients get their turn in
            # between.
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
