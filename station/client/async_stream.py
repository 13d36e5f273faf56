"""A stream for asyncio, which connects again by itself."""

import asyncio
from collections.abc import AsyncIterator

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

from station.client.errors import StationUnreachableError
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

    `async for` over it; cancel the task, or leave the loop, to end it. The station's
    first frame does not come as an item but as `progress.hello`; a new `boot_id` in a
    frame means that the station restarted.

    Args:
        options: Where it comes from.

    Raises:
        ApiError: While iterating: the station refuses the stream, or the link broke
            and `reconnect` is off.
    """

    def __init__(self, options: StreamOptions) -> None:
        self.options = options
        self.progress = StreamProgress()

    async def __aiter__(self) -> AsyncIterator[StreamFrame]:
        """Yield frames until the loop over them is left.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        # One generator, not two nested ones: left early, it closes its connection.
        backoff = Backoff()
        while True:
            try:
                async with self._connect() as connection:
                    while True:
                        frame = self.progress.accept(await connection.recv())
                        if frame is not None:
                            backoff.reset()
                            yield frame
            except (OSError, WebSocketException) as error:
                refused = refusal(error)
                if refused is not None:
                    raise refused from error
                if not self.options.reconnect:
                    raise StationUnreachableError(
                        self.options.base_url, error
                    ) from error
            finally:
                self.progress.connected = False
            await asyncio.sleep(backoff.next())

    def _connect(self) -> connect:
        return connect(
            self.options.url(),
            additional_headers=bearer(self.options.token),
            compression=None,
            max_size=MAX_FRAME_BYTES,
            proxy=None,
            close_timeout=1.0,
        )
