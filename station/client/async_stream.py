"""A stream for asyncio, which connects again by itself."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from types import TracebackType
from typing import Self

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from station.client.errors import StationUnreachableError, StreamTimeoutError
from station.client.stream_options import (
    MAX_FRAME_BYTES,
    Backoff,
    StreamOptions,
    StreamProgress,
    bearer,
    refusal,
)
from station.wire import StreamFrame


class AsyncStream:
    """Frames of a topic; a slow reader misses frames.

    `async with` connects at once and raises when that fails; without it, the first
    frame that is asked for connects. Cancel the task, or leave the loop, to end it. The
    station's first frame does not come as an item but as `progress.hello`; a new
    `boot_id` in a frame means that the station restarted.

    Args:
        options: Where it comes from.

    Raises:
        ApiError: While reading: the station refuses the stream, or the link broke
            and `reconnect` is off.
    """

    def __init__(self, options: StreamOptions) -> None:
        self.options = options
        self.progress = StreamProgress()
        self._connection: ClientConnection | None = None
        self._backoff = Backoff()

    async def __aenter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        try:
            await self._connect()
        except (OSError, WebSocketException) as error:
            await self.close()
            raise refusal(error) or StationUnreachableError(
                self.options.base_url, error
            ) from error
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Close the connection; asking for a frame connects again."""
        connection, self._connection = self._connection, None
        self.progress.connected = False
        if connection is not None:
            await connection.close()

    async def __aiter__(self) -> AsyncIterator[StreamFrame]:
        """Yield frames until the loop over them is left."""
        try:
            while True:
                yield await self.receive()
        finally:
            await self.close()

    async def wait_for(
        self, predicate: Callable[[StreamFrame], bool], timeout: float | None = None
    ) -> StreamFrame:
        """Return the first frame that fulfils a condition.

        Args:
            predicate: The condition, e.g. `lambda frame: frame.stamp > 5.0`.
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No such frame came in time.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            left = None if deadline is None else deadline - time.monotonic()
            frame = await self.receive(left)
            if predicate(frame):
                return frame

    async def receive(self, timeout: float | None = None) -> StreamFrame:
        """Return the next frame.

        Args:
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No frame came in time.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        try:
            async with asyncio.timeout(timeout):
                return await self._receive()
        except TimeoutError as error:
            raise StreamTimeoutError(self.options.topic, timeout) from error

    async def _receive(self) -> StreamFrame:
        while True:
            try:
                connection = self._connection or await self._connect()
                frame = self.progress.accept(await connection.recv())
            except (OSError, WebSocketException) as error:
                await self.close()
                refused = refusal(error)
                if refused is not None:
                    raise refused from error
                if not self.options.reconnect:
                    raise StationUnreachableError(
                        self.options.base_url, error
                    ) from error
                await asyncio.sleep(self._backoff.next())
                continue
            if frame is not None:
                self._backoff.reset()
                return frame

    async def _connect(self) -> ClientConnection:
        connection = await connect(
            self.options.url(),
            additional_headers=bearer(self.options.token),
            compression=None,
            max_size=MAX_FRAME_BYTES,
            proxy=None,
            ssl=self.options.tls,
            open_timeout=self.options.timeout,
            close_timeout=1.0,
        )
        self._connection = connection
        async with asyncio.timeout(self.options.timeout):
            self.progress.accept(await connection.recv())
        return connection
