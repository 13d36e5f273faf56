"""A stream for plain Python, which connects again by itself."""

import threading
from collections.abc import Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Self

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

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

if TYPE_CHECKING:
    from websockets.sync.connection import Connection


class Stream:
    """Frames of a topic; a slow reader misses frames.

    Iterate over it in one thread; `close()` from any other ends the iteration. The
    station's first frame does not come as an item but as `progress.hello`; a new
    `boot_id` in a frame means that the station restarted.

    Args:
        options: Where it comes from.

    Raises:
        ApiError: While iterating: the station refuses the stream, or the link broke
            and `reconnect` is off.
    """

    def __init__(self, options: StreamOptions) -> None:
        self.options = options
        self.progress = StreamProgress()
        self._closed = threading.Event()
        self._connection: Connection | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the stream; an iteration under way ends."""
        self._closed.set()
        connection = self._connection
        if connection is not None:
            connection.close()

    def __iter__(self) -> Iterator[StreamFrame]:
        """Yield frames until closed."""
        backoff = Backoff()
        while not self._closed.is_set():
            try:
                for frame in self._read():
                    backoff.reset()
                    yield frame
            except (OSError, WebSocketException) as error:
                self._judge(error)
            finally:
                self.progress.connected = False
            self._closed.wait(backoff.next())

    def _judge(self, error: Exception) -> None:
        """Return when connecting again makes sense; raise the reason when it does not.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        if self._closed.is_set():
            return
        refused = refusal(error)
        if refused is not None:
            raise refused from error
        if not self.options.reconnect:
            raise StationUnreachableError(self.options.base_url, error) from error

    def _read(self) -> Iterator[StreamFrame]:
        with connect(
            self.options.url(),
            additional_headers=bearer(self.options.token),
            compression=None,
            max_size=MAX_FRAME_BYTES,
            proxy=None,
            close_timeout=1.0,
        ) as connection:
            self._connection = connection
            while not self._closed.is_set():
                frame = self.progress.accept(connection.recv())
                if frame is not None:
                    yield frame
