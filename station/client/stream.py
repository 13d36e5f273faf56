"""A stream for plain Python, which connects again by itself."""

import threading
import time
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Self

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

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

if TYPE_CHECKING:
    from websockets.sync.connection import Connection


class Stream:
    """Frames of a topic; a slow reader misses frames.

    `with` connects at once and raises when that fails; without it, the first frame that
    is asked for connects. Read it in one thread; `close()` from any other ends the
    iteration. The station's first frame does not come as an item but as
    `progress.hello`; a new `boot_id` in a frame means that the station restarted.

    Args:
        options: Where it comes from.

    Raises:
        ApiError: While reading: the station refuses the stream, or the link broke
            and `reconnect` is off.
    """

    def __init__(self, options: StreamOptions) -> None:
        self.options = options
        self.progress = StreamProgress()
        self._closed = threading.Event()
        self._connection: Connection | None = None
        self._backoff = Backoff()

    def __enter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        try:
            self._connect(None)
        except (OSError, WebSocketException) as error:
            self._disconnect()
            raise refusal(error) or StationUnreachableError(
                self.options.base_url, error
            ) from error
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
        self._disconnect()

    def __iter__(self) -> Iterator[StreamFrame]:
        """Yield frames until closed; leaving the loop closes the connection."""
        try:
            while (frame := self._receive(None)) is not None:
                yield frame
        finally:
            self._disconnect()

    def receive(self, timeout: float | None = None) -> StreamFrame:
        """Return the next frame.

        Args:
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No frame came in time.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        return self.wait_for(lambda _: True, timeout)

    def wait_for(
        self, predicate: Callable[[StreamFrame], bool], timeout: float | None = None
    ) -> StreamFrame:
        """Return the first frame that fulfils a condition.

        Args:
            predicate: The condition, e.g. `lambda frame: frame.stamp > 5.0`.
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No such frame came in time, or the stream was closed.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while (frame := self._receive(deadline)) is not None:
            if predicate(frame):
                return frame
        raise StreamTimeoutError(self.options.topic, timeout)

    def _receive(self, deadline: float | None) -> StreamFrame | None:
        """Return the next frame; None when it is too late for one, or closed."""
        while not self._closed.is_set():
            left = None if deadline is None else deadline - time.monotonic()
            if left is not None and left <= 0.0:
                return None
            try:
                connection = self._connection or self._connect(left)
                message = _message(connection, left)
            except (OSError, WebSocketException) as error:
                self._disconnect()
                self._judge(error)
                pause = self._backoff.next()
                self._closed.wait(pause if left is None else min(pause, left))
                continue
            frame = None if message is None else self.progress.accept(message)
            if frame is not None:
                self._backoff.reset()
                return frame
        return None

    def _connect(self, timeout: float | None) -> "Connection":
        limit = self.options.timeout
        connection = connect(
            self.options.url(),
            additional_headers=bearer(self.options.token),
            compression=None,
            max_size=MAX_FRAME_BYTES,
            proxy=None,
            ssl=self.options.tls,
            open_timeout=limit if timeout is None else min(limit, timeout),
            close_timeout=1.0,
        )
        self._connection = connection
        hello = connection.recv(timeout=limit)
        self.progress.accept(hello)
        return connection

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        self.progress.connected = False
        if connection is not None:
            connection.close()

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


def _message(connection: "Connection", timeout: float | None) -> str | bytes | None:
    """Return the next message; None when none came in time."""
    try:
        return connection.recv(timeout=timeout)
    except TimeoutError:
        return None
