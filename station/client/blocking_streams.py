"""Streams for plain Python, which run the asyncio streams in a thread's event loop."""

import asyncio
import os
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Coroutine, Iterator, Sequence
from concurrent.futures import CancelledError, Future, wait
from typing import Any, Self, TypeVar

from station.client.errors import StreamTimeoutError
from station.client.streams import (
    CLOSE_TIMEOUT,
    AsyncCommandStream,
    AsyncStream,
    written,
)
from station.wire import CommandCounts, StreamFrame

MOST_PENDING = 256
"""Most set-points that wait for a slow link; the oldest are dropped."""
R = TypeVar("R")


class Portal:
    """An event loop in a thread, which runs while a stream of this process is open."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Use a new loop from now on, as a forked child lacks the old loop's thread."""
        self._lock = threading.Lock()
        self._users: set[object] = set()
        self._stop: Callable[[], None] = _do_nothing

    def start(self, user: object, coroutine: Coroutine[Any, Any, R]) -> "Future[R]":
        """Start a coroutine in the loop, which runs until its last user leaves."""
        with self._lock:
            if not self._users:
                self._begin()
            self._users.add(user)
            return asyncio.run_coroutine_threadsafe(coroutine, self._loop)

    def run(self, user: object, coroutine: Coroutine[Any, Any, R]) -> R:
        """Run a coroutine in the loop; cancel it if the wait is interrupted."""
        return _outcome(self.start(user, coroutine))

    def serves(self, user: object) -> bool:
        """Return whether the loop has this user."""
        return user in self._users

    def call(self, act: Callable[[], None]) -> None:
        """Call a function in the loop soon; the loop must have a user."""
        self._loop.call_soon_threadsafe(act)

    def leave(self, user: object) -> None:
        """Remove a user, and end the loop after the last one."""
        with self._lock:
            if user in self._users:
                self._users.remove(user)
                if not self._users:
                    self._stop()

    def run_alone(self, coroutine: Coroutine[Any, Any, R]) -> R:
        """Run a coroutine as the only work of its user."""
        user = object()
        try:
            return self.run(user, coroutine)
        finally:
            self.leave(user)

    def _begin(self) -> None:
        begun: Future[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = Future()

        async def live() -> None:
            end = asyncio.Event()
            begun.set_result((asyncio.get_running_loop(), end))
            await end.wait()

        # A daemon thread does not delay the exit of a program that leaves a stream
        # open.
        thread = threading.Thread(
            target=lambda: asyncio.run(live()), name="streams", daemon=True
        )
        thread.start()
        loop, end = begun.result()

        def stop() -> None:
            loop.call_soon_threadsafe(end.set)
            thread.join()

        self._loop, self._stop = loop, stop


def _do_nothing() -> None:
    """Do nothing, because no loop runs."""


def _outcome(future: "Future[R]") -> R:
    """Wait for the end of a coroutine in the loop; cancel it on Ctrl-C."""
    try:
        return future.result()
    except BaseException:
        # Ctrl-C ends only the wait; the coroutine must end, too.
        future.cancel()
        raise


PORTAL = Portal()
"""The event loop of this process."""
# A child process has only the thread that forked, and so no loop.
os.register_at_fork(after_in_child=PORTAL.forget)


def _enter(stream: object, source: AsyncStream | AsyncCommandStream) -> None:
    """Connect a stream in the loop."""
    try:
        PORTAL.run(stream, source.__aenter__())
    except BaseException:
        PORTAL.leave(stream)
        raise


def _leave(
    stream: object, source: AsyncStream | AsyncCommandStream, leaving: threading.RLock
) -> None:
    """End the connection of a stream, and the loop after the last stream."""
    # A second thread must wait: otherwise it would end the loop before the connection
    # is closed.
    with leaving:
        if not PORTAL.serves(stream):
            return
        try:
            PORTAL.run(stream, source.close())
        finally:
            PORTAL.leave(stream)


class Stream:
    """Frames of a topic; a slow reader misses frames.

    `with` connects at once and raises an error when that fails; without it, reading the
    first frame connects. Read a stream in one thread; `close()` in any thread ends the
    iteration. The station's first frame is not an item of the iteration, but
    `progress.hello`. A new `boot_id` in a frame means that the station has restarted.

    Raises:
        ApiError: While reading: the station refuses the stream, or the link broke
            and `reconnect` is off.
    """

    def __init__(self, source: AsyncStream) -> None:
        self._source = source
        self.options = source.options
        self.progress = source.progress
        self._is_closed = False
        self._leaving = threading.RLock()
        self._receiving: Future[StreamFrame] | None = None

    def __enter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        _enter(self, self._source)
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the stream; an iteration under way ends."""
        self._is_closed = True
        if self._receiving is not None:
            # This wakes a thread that waits for a frame.
            self._receiving.cancel()
        _leave(self, self._source, self._leaving)

    def __iter__(self) -> Iterator[StreamFrame]:
        """Yield frames until closed; leaving the loop closes the connection."""
        try:
            while not self._is_closed:
                yield self.receive()
        except StreamTimeoutError:
            return  # the stream was closed: there is no time limit
        finally:
            # At the exit of the program the thread that would close the link is gone.
            if not sys.is_finalizing():
                _leave(self, self._source, self._leaving)

    def receive(self, timeout: float | None = None) -> StreamFrame:
        """Return the next frame.

        Args:
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No frame came in time, or the stream was closed.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        receiving = PORTAL.start(self, self._source.receive(timeout))
        self._receiving = receiving
        if self._is_closed:
            receiving.cancel()
        try:
            return _outcome(receiving)
        except CancelledError:
            raise StreamTimeoutError(self.options.topic, timeout) from None

    def wait_for(
        self, predicate: Callable[[StreamFrame], bool], timeout: float | None = None
    ) -> StreamFrame:
        """Return the first frame that meets a condition.

        Args:
            predicate: The condition, e.g. `lambda frame: frame.stamp > 5.0`.
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No such frame came in time, or the stream was closed.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        # Call the condition, which is the user's code, in the user's thread.
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            left = None if deadline is None else deadline - time.monotonic()
            try:
                frame = self.receive(left)
            except StreamTimeoutError:
                raise StreamTimeoutError(self.options.topic, timeout) from None
            if predicate(frame):
                return frame


class CommandStream:
    """Sends set-points in a `with` block; a newer one replaces those that wait.

    When the program sends nothing for `timeout`, or the link is lost, the last
    set-point expires, and the controller's `command_timeout` parameters decide what it
    does.
    """

    def __init__(self, source: AsyncCommandStream) -> None:
        self._source = source
        self.options = source.options
        self._leaving = threading.RLock()
        self._pending: deque[str | None] = deque()
        self._arrived = asyncio.Event()
        self._sending: Future[None] | None = None

    @property
    def counts(self) -> CommandCounts | None:
        """Last report of the station on the set-points; None before any report."""
        return self._source.counts

    def __enter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        _enter(self, self._source)
        # An event belongs to one loop, and each connection may have another loop.
        self._pending, self._arrived = deque(maxlen=MOST_PENDING), asyncio.Event()
        self._sending = PORTAL.start(self, self._send_pending())
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the stream; the last set-point expires after its timeout."""
        sending, self._sending = self._sending, None
        if sending is not None:
            self._offer(None)
            # Set-points sent before `close` are still sent, if the link accepts them.
            wait([sending], timeout=CLOSE_TIMEOUT)
            sending.cancel()
        _leave(self, self._source, self._leaving)

    def send(
        self,
        values: Sequence[float],
        *,
        epoch: int | None = None,
        rates: Sequence[float] | None = None,
    ) -> None:
        """Send a set-point, without waiting for the station.

        Args:
            values: One number per element of the controller, in its order and units.
            epoch: Epoch of the set-point; the station refuses it after a later stop or
                reset.
            rates: How fast the set-point changes [rad/s or m/s].

        Raises:
            ApiError: The station has ended the stream, e.g. because control was lost.
            StationUnreachableError: The link broke, or there is no link.
            ValueError: A number is not finite.
        """
        message = written(values, epoch, rates)
        self._source.link()
        # Sending has failed: raise the error to the caller of `send`.
        if self._sending is not None and self._sending.done():
            self._sending.result()
        self._offer(message)

    def _offer(self, message: str | None) -> None:
        """Let the loop send a message, or end the sending with None.

        This makes no future or task per message, and a late loop sends all waiting
        messages at once, because the cost would matter at 1 kHz.
        """
        self._pending.append(message)
        # With more messages the loop is already awake; waking it costs more than
        # sending one.
        if len(self._pending) == 1:
            PORTAL.call(self._arrived.set)

    async def _send_pending(self) -> None:
        """Send the offered messages in order; a slow link drops the oldest."""
        while True:
            await self._arrived.wait()
            self._arrived.clear()
            while self._pending:
                message = self._pending.popleft()
                if message is None:
                    return
                await self._source.post(message)
