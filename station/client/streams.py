"""Streams over WebSockets: frames of a topic from the station, set-points to it."""

import asyncio
import json
import math
import random
import ssl
import time
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, NoReturn, Self
from urllib.parse import quote, urlencode

from pydantic import JsonValue, ValidationError
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus, WebSocketException

from station import wire
from station.client.errors import ApiError, StationUnreachableError, StreamTimeoutError
from station.client.samples import Samples
from station.wire.protocol import LEASE_HEADER, PREFIX

Rate = float | Literal["full"]
FIRST_DELAY: Final = 0.2
LONGEST_DELAY: Final = 5.0
MAX_FRAME_BYTES: Final = 16 * 1024 * 1024
CLOSE_TIMEOUT: Final = 1.0
"""Longest wait for the station to confirm the end of a stream [s]."""

REFUSALS: Mapping[int, tuple[str, str]] = {
    wire.CLOSE_BAD_REQUEST: ("bad_stream_request", "Correct rate, fields or format."),
    wire.CLOSE_UNAUTHORIZED: ("unauthorized", "Give the client the station's token."),
    wire.CLOSE_FORBIDDEN: (
        "forbidden",
        "Use the address and token the station printed.",
    ),
    wire.CLOSE_CONTROL_HELD: ("control_held", "Ask for control, or take it by force."),
    wire.CLOSE_UNKNOWN_TOPIC: ("unknown_topic", "Ask for a topic the station has."),
}
"""Close codes after which connecting again is pointless: code and remedy."""


def bearer(token: str | None) -> dict[str, str]:
    """Return the header that carries `token`; empty without a token."""
    return {} if token is None else {"Authorization": f"Bearer {token}"}


def certificates(tls: ssl.SSLContext | None) -> ssl.SSLContext:
    """Return the context that checks a server; for plain HTTP it trusts nobody.

    Args:
        tls: The context of a station with https; None for plain HTTP, where reading the
            authorities of the system would delay each client by 50 ms.
    """
    return ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT) if tls is None else tls


async def close_connection(connection: ClientConnection) -> None:
    """Close a connection; its socket is closed even if the caller is cancelled here."""
    try:
        await connection.close()
    finally:
        # A cancelled `close` gives up waiting for the other side's answer, and would
        # leave the socket to the garbage collector.
        connection.transport.abort()


@dataclass(frozen=True, slots=True)
class StreamOptions:
    """Address and options of a stream.

    Attributes:
        base_url: URL of the station, http or https.
        token: Operator or viewer token.
        topic: Topic to stream.
        rate: Frames per second [Hz], or "full"; None means the station's default.
        fields: Keys of `data` to send; all when empty.
        reconnect: Whether to connect again when the link breaks.
        timeout: Longest wait for a connection [s].
        tls: TLS context that checks the station's certificate; None for plain HTTP.
    """

    base_url: str
    token: str | None
    topic: str
    rate: Rate | None = None
    fields: tuple[str, ...] = ()
    reconnect: bool = True
    timeout: float = 10.0
    tls: ssl.SSLContext | None = None

    def url(self) -> str:
        """Return the WebSocket URL."""
        query: dict[str, str] = {}
        if self.rate is not None:
            query["rate"] = str(self.rate)
        if self.fields:
            query["fields"] = ",".join(self.fields)
        base = "ws" + self.base_url.removeprefix("http")
        path = f"{PREFIX}/streams/{quote(self.topic)}"
        return f"{base}{path}?{urlencode(query)}" if query else base + path


class Backoff:
    """Delays between attempts to connect, which double, with jitter."""

    def __init__(self) -> None:
        self._delay = FIRST_DELAY

    def reset(self) -> None:
        """Start again with the first delay, after a successful connection."""
        self._delay = FIRST_DELAY

    def next(self) -> float:
        """Return the next delay [s], 50 to 100 % of the doubled one."""
        delay = self._delay
        self._delay = min(2.0 * delay, LONGEST_DELAY)
        return delay * random.uniform(0.5, 1.0)


class StreamProgress:
    """State of a stream.

    Attributes:
        connected: Whether the link is up and its first frame has come.
        hello: The newest first frame: boot_id, epoch and a full snapshot.
        connections: Number of connections so far.
    """

    def __init__(self) -> None:
        self.connected = False
        self.hello: wire.StreamFrame | None = None
        self.connections = 0

    def accept(self, message: str | bytes) -> wire.StreamFrame | None:
        """Read a message; return its frame, or None for the first message (`hello`)."""
        frame = wire.StreamFrame.model_validate_json(message)
        if frame.topic == "hello":
            self.hello = frame
            self.connected = True
            self.connections += 1
            return None
        boot_id = self.hello.boot_id if self.hello is not None else ""
        return frame.model_copy(update={"boot_id": boot_id})

    def snapshot(self) -> dict[str, JsonValue]:
        """Return the full snapshot of the newest hello; empty before any hello."""
        return {} if self.hello is None else self.hello.data


def refusal(error: Exception) -> ApiError | None:
    """Return the error to raise if connecting again is pointless, else None."""
    if isinstance(error, InvalidStatus) and error.response.status_code < 500:
        return ApiError.from_body(
            error.response.status_code, bytes(error.response.body or b"")
        )
    if isinstance(error, ConnectionClosed) and error.rcvd is not None:
        known = REFUSALS.get(error.rcvd.code)
        if known is not None:
            return ApiError(
                error.rcvd.reason or "The station closed the stream.",
                status=error.rcvd.code,
                code=known[0],
                remedy=known[1],
            )
    return None


def _give_up(error: Exception, url: str) -> NoReturn:
    """Raise the error for a failed link to a station.

    Raises:
        ApiError: The station refuses the link.
        StationUnreachableError: The station does not answer.
    """
    raise refusal(error) or StationUnreachableError(url, error) from error


class AsyncStream:
    """Frames of a topic; a slow reader misses frames.

    `async with` connects at once and raises an error when that fails; without it,
    reading the first frame connects. Cancel the task, or leave the loop, to end the
    stream. The station's first frame is not an item of the iteration, but
    `progress.hello`. A new `boot_id` in a frame means that the station has restarted.

    Args:
        options: Station, topic and rate of the stream.

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
            _give_up(error, self.options.base_url)
        except BaseException:
            # The entry was interrupted, so the end of the block will not close the
            # link. The loop may end at once, so there is no time for a closing
            # handshake.
            if self._connection is not None:
                self._connection.transport.abort()
            raise
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """Close the connection; reading another frame connects again."""
        connection, self._connection = self._connection, None
        self.progress.connected = False
        if connection is not None:
            await close_connection(connection)

    async def __aiter__(self) -> AsyncIterator[wire.StreamFrame]:
        """Yield frames until the caller leaves the iteration."""
        try:
            while True:
                yield await self.receive()
        finally:
            await self.close()

    async def wait_for(
        self,
        predicate: Callable[[wire.StreamFrame], bool],
        timeout: float | None = None,
    ) -> wire.StreamFrame:
        """Return the first frame that meets a condition.

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

    async def collect(self, seconds: float, patience: float) -> Samples:
        """Connect, and return the samples of some seconds.

        Args:
            seconds: Station time to collect [s], > 0.
            patience: Longest wait for the next frame [s].

        Raises:
            ApiError: The station refuses the stream.
            StreamTimeoutError: No frame comes, e.g. because the simulation is paused.
        """
        samples = Samples(self.options.topic)
        async with self:
            while samples.duration < seconds:
                samples.add(await self.receive(patience))
        samples.cut(seconds)
        return samples

    async def receive(self, timeout: float | None = None) -> wire.StreamFrame:
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

    async def _receive(self) -> wire.StreamFrame:
        while True:
            try:
                connection = self._connection or await self._connect()
                frame = self.progress.accept(await connection.recv())
            except (OSError, WebSocketException) as error:
                await self.close()
                if not self.options.reconnect or refusal(error) is not None:
                    _give_up(error, self.options.base_url)
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
            close_timeout=CLOSE_TIMEOUT,
        )
        self._connection = connection
        async with asyncio.timeout(self.options.timeout):
            self.progress.accept(await connection.recv())
        return connection


@dataclass(frozen=True, slots=True)
class CommandOptions:
    """Address and options of a stream of set-points.

    Attributes:
        base_url: URL of the station, http or https.
        token: Operator token.
        lease: The lease of control under which the stream sends; None without one.
        controller: The controller.
        timeout: Silence after which the last set-point expires [s], > 0.
        patience: Longest wait for a connection [s].
        tls: TLS context that checks the station's certificate; None for plain HTTP.
    """

    base_url: str
    token: str | None
    lease: str | None
    controller: str
    timeout: float = 0.2
    patience: float = 10.0
    tls: ssl.SSLContext | None = None

    def url(self) -> str:
        """Return the WebSocket URL."""
        base = "ws" + self.base_url.removeprefix("http")
        path = f"{PREFIX}/streams/command/{quote(self.controller, safe='')}"
        return f"{base}{path}?{urlencode({'timeout': self.timeout})}"

    def headers(self) -> dict[str, str]:
        """Return the headers with the token and the lease of control."""
        lease = {} if self.lease is None else {LEASE_HEADER: self.lease}
        return {**bearer(self.token), **lease}


def written(
    values: Sequence[float], epoch: int | None, rates: Sequence[float] | None
) -> str:
    """Return the message with a set-point.

    Args:
        values: The set-point.
        epoch: Epoch of the set-point; None for the present one.
        rates: How fast the set-point changes [rad/s or m/s]; None if unknown.

    Raises:
        ValueError: A number is not finite.
    """
    numbers = [*values, *(rates or [])]
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"A set-point has finite numbers alone; these are {numbers}.")
    message: dict[str, object] = {"command": list(values)}
    if epoch is not None:
        message["epoch"] = epoch
    if rates is not None:
        message["rates"] = list(rates)
    return json.dumps(message)


class AsyncCommandStream:
    """Sends set-points in `async with`; a newer one replaces those that wait.

    When the program sends nothing for `timeout`, or the link is lost, the last
    set-point expires, and the controller's `command_timeout` parameters decide what it
    does.

    Args:
        options: Station and controller of the stream.

    Attributes:
        counts: The station's last report on the set-points it has received; None before
            the first report.
    """

    def __init__(self, options: CommandOptions) -> None:
        self.options = options
        self.counts: wire.CommandCounts | None = None
        self._connection: ClientConnection | None = None
        self._reader: asyncio.Task[None] | None = None
        self._broken: Exception | None = None

    async def __aenter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        options = self.options
        try:
            self._connection = await connect(
                options.url(),
                additional_headers=options.headers(),
                compression=None,
                proxy=None,
                ssl=options.tls,
                open_timeout=options.patience,
                close_timeout=CLOSE_TIMEOUT,
            )
        except (OSError, WebSocketException) as error:
            _give_up(error, options.base_url)
        self._broken = None
        self._reader = asyncio.create_task(self._read(self._connection))
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """End the stream; the last set-point expires after its timeout."""
        connection, self._connection = self._connection, None
        if connection is not None:
            await close_connection(connection)
        if self._reader is not None:
            await asyncio.wait([self._reader])

    async def send(
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
        await self.post(written(values, epoch, rates))

    async def post(self, message: str) -> None:
        """Send an encoded set-point; raise the errors of `send`."""
        try:
            await self.link().send(message)
        except (OSError, WebSocketException) as error:
            _give_up(error, self.options.base_url)
        # A fast link does not suspend `send`. Without this pause a program that sends
        # in a tight loop would never read the reports, nor notice the end of the
        # stream.
        await asyncio.sleep(0)

    def link(self) -> ClientConnection:
        """Return the connection; raise the errors of `send` without one.

        Raises:
            ApiError: The station has ended the stream.
            StationUnreachableError: The link broke, or there is no link.
        """
        if self._connection is None:
            closed = ConnectionError("The stream is not open; it opens in a `with`.")
            raise StationUnreachableError(self.options.base_url, closed)
        if self._broken is not None:
            _give_up(self._broken, self.options.base_url)
        return self._connection

    async def _read(self, connection: ClientConnection) -> None:
        """Read the station's reports until the link ends, for whatever reason."""
        try:
            while True:
                message = await connection.recv()
                self.counts = wire.CommandCounts.model_validate_json(message)
        except (OSError, WebSocketException, ValidationError) as error:
            self._broken = error
