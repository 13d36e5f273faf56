"""Streams for plain Python: those of asyncio, in an event loop in a thread."""

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
"""So many set-points wait for a link that is too slow; the newest win."""
R = TypeVar("R")


class Portal:
    """An event loop in a thread, which runs while a stream of this process is open."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Begin with another loop next time; for a fork, which has no such thread."""
        self._lock = threading.Lock()
        self._users: set[object] = set()
        self._stop: Callable[[], None] = _do_nothing

    def start(self, user: object, coroutine: Coroutine[Any, Any, R]) -> "Future[R]":
        """Begin to run a coroutine in the loop, which goes on until its user leaves."""
        with self._lock:
            if not self._users:
                self._begin()
            self._users.add(user)
            return asyncio.run_coroutine_threadsafe(coroutine, self._loop)

    def run(self, user: object, coroutine: Coroutine[Any, Any, R]) -> R:
        """Run a coroutine in the loop; it is cancelled when the wait is interrupted."""
        return _outcome(self.start(user, coroutine))

    def serves(self, user: object) -> bool:
        """Return whether a user has not left yet."""
        return user in self._users

    def call(self, act: Callable[[], None]) -> None:
        """Do something in the loop, soon; a user is there."""
        self._loop.call_soon_threadsafe(act)

    def leave(self, user: object) -> None:
        """End the loop with its last user."""
        with self._lock:
            if user in self._users:
                self._users.remove(user)
                if not self._users:
                    self._stop()

    def run_alone(self, coroutine: Coroutine[Any, Any, R]) -> R:
        """Run a coroutine that leaves nothing in the loop."""
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

        # It does not hold up the end of a program that leaves a stream open.
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
    """Stop nothing: no loop runs."""


def _outcome(future: "Future[R]") -> R:
    """Wait for the end of a coroutine in the loop; cancel it on Ctrl-C."""
    try:
        return future.result()
    except BaseException:
        # Ctrl-C ends the wait alone; what was waited for must end, too.
        future.cancel()
        raise


PORTAL = Portal()
"""The event loop of this process."""
# A child process has no threads but the one that forked, and so no loop.
os.register_at_fork(after_in_child=PORTAL.forget)


def _enter(stream: object, source: AsyncStream | AsyncCommandStream) -> None:
    """Connect a stream, in the loop."""
    try:
        PORTAL.run(stream, source.__aenter__())
    except BaseException:
        PORTAL.leave(stream)
        raise


def _leave(
    stream: object, source: AsyncStream | AsyncCommandStream, leaving: threading.RLock
) -> None:
    """End the connection of a stream, and the loop with the last one."""
    # A second thread waits: it would end the loop before the connection is closed.
    with leaving:
        if not PORTAL.serves(stream):
            return
        try:
            PORTAL.run(stream, source.close())
        finally:
            PORTAL.leave(stream)


class Stream:
    """Frames of a topic; a slow reader misses frames.

    `with` connects at once and raises when that fails; without it, the first frame
    that is read connects. Read it in one thread; `close()` from any other ends the
    iteration. The station's first frame is no item of the iteration, but
    `progress.hello`; a new `boot_id` in a frame means that the station restarted.

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
            # A thread that waits for a frame wakes up.
            self._receiving.cancel()
        _leave(self, self._source, self._leaving)

    def __iter__(self) -> Iterator[StreamFrame]:
        """Yield frames until closed; leaving the loop closes the connection."""
        try:
            while not self._is_closed:
                yield self.receive()
        except StreamTimeoutError:
            return  # it was closed, for there is no time limit
        finally:
            # At the end of the program there is no thread that could close anything.
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
        """Return the first frame that fulfils a condition.

        Args:
            predicate: The condition, e.g. `lambda frame: frame.stamp > 5.0`.
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No such frame came in time, or the stream was closed.
            StationUnreachableError: The link broke and `reconnect` is off.
        """
        # The condition is the user's own, and so is the thread in which it is asked.
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
    """Sends set-points one after the other; the newest wins. Use it in a `with` block.

    When the program sends nothing for `timeout`, the last set-point expires and the
    controller does what its `command_timeout` parameters say, as after a lost link.
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
        """Last report of the station on the set-points; None before the first."""
        return self._source.counts

    def __enter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        _enter(self, self._source)
        # An event belongs to the loop in which it is waited for, and each has its own.
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
            # The set-points sent before `close` still go out, if the link takes them.
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
        """Send a set-point; does not wait for the station.

        Args:
            values: One number per element of the controller, in its order and units.
            epoch: Refuse when a stop or reset came since that epoch.
            rates: How fast the set-point changes [rad/s or m/s].

        Raises:
            ApiError: The station has ended the stream, e.g. because control was lost.
            StationUnreachableError: The link broke, or there is no link.
            ValueError: A number is not finite.
        """
        message = written(values, epoch, rates)
        self._source.link()
        # Sending has failed: the error belongs to the caller of `send`.
        if self._sending is not None and self._sending.done():
            self._sending.result()
        self._offer(message)

    def _offer(self, message: str | None) -> None:
        """Let the loop send a message, or with None come to an end.

        Neither a future nor a task is made of it, and a loop that is late sends all
        that is there at once: at 1 kHz the program would feel the difference.
        """
        self._pending.append(message)
        # Otherwise the loop is awake already; waking it costs more than a set-point.
        if len(self._pending) == 1:
            PORTAL.call(self._arrived.set)

    async def _send_pending(self) -> None:
        """Send the offered messages in order; a slow link loses the oldest."""
        while True:
            await self._arrived.wait()
            self._arrived.clear()
            while self._pending:
                message = self._pending.popleft()
                if message is None:
                    return
                await self._source.post(message)
