"""A web server whose clients cannot exhaust its connections or file descriptors.

A client that opens connections and sends nothing, sends a header or a body byte by
byte, or does not read its answer, keeps a file descriptor. When a process has no
descriptor left, it accepts no connection, and no client can stop the robot. So every
step of a request has a time limit, and the number of connections stays below the limit
of descriptors. When there are too many, a new connection replaces the one that has kept
the server waiting longest. A stop sends its request at once, and is therefore never
replaced.
"""

import asyncio
import errno
import logging
import os
import resource
import socket
from collections.abc import Iterable
from enum import Enum
from typing import Any, cast

import uvicorn
from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from typing_extensions import override
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

MOST_CONNECTIONS = 256
"""Most connections at a time, WebSockets among them."""
# Log files, recordings, the database of events, pipes to other processes.
RESERVED_DESCRIPTORS = 40
"""File descriptors that are kept free for the rest of the process."""
EXTRA_CONNECTIONS = 16
"""Connections that are accepted beyond the limit when all are at work, for a stop."""
ACCEPTED_AT_ONCE = 8
"""Connections that one turn of the event loop accepts, before it counts them."""
LEAST_CONNECTIONS = 4
"""Limit of connections of a process that may open only a few files. `EXTRA_CONNECTIONS`
and `ACCEPTED_AT_ONCE` are replaced by 2 then."""
WAITING_CONNECTIONS = 1024
"""Connections that the operating system queues until they are accepted."""
LOOK_PERIOD = 0.5
"""Time between two checks of a connection [s]."""


NO_UTF8 = 1007
"""Close code of a WebSocket for a text that is not UTF-8 (RFC 6455, 7.4.1)."""
_OUT_OF_FILES = frozenset({errno.EMFILE, errno.ENFILE})
_log = logging.getLogger(__name__)


class Phase(Enum):
    """Phase of a connection."""

    REQUEST = "request"
    """The server waits for the header of the next request."""
    BODY = "body"
    """The server waits for the rest of a body."""
    WORK = "work"
    """The application computes the answer."""
    ANSWER = "answer"
    """The server waits until the client reads its answer."""


TIME_LIMITS = {Phase.REQUEST: 5.0, Phase.BODY: 10.0, Phase.ANSWER: 10.0}
"""Longest time of a phase [s]; the application's work has no limit."""
LEAST_PART = 16 * 1024
"""Bytes of a body that must come between two checks to restart its time limit: a large
file may take long, a body that trickles may not."""


class LimitedProtocol(H11Protocol):
    """One HTTP connection.

    Attributes:
        most: Most connections of the server at a time.
        extra: Connections that are accepted beyond `most` when all are at work.
        phase: Phase of the connection at the last check.
        since: When that phase began [s, clock of the event loop].
        received: Bytes that have come since the last check.
    """

    most = MOST_CONNECTIONS
    extra = EXTRA_CONNECTIONS
    phase = Phase.REQUEST
    since = 0.0
    received = 0

    @override
    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn has it
        super().connection_made(transport)
        self.since = self.loop.time()
        # Accept the new connection before another one ends: it may ask for a stop.
        if len(self.connections) > self.most:
            self._make_room()
        self.loop.call_later(LOOK_PERIOD, self._look)

    @override
    def data_received(self, data: bytes) -> None:
        self.received += len(data)
        super().data_received(data)

    @override
    def on_response_complete(self) -> None:
        super().on_response_complete()
        self.phase, self.since = Phase.REQUEST, self.loop.time()

    def present_phase(self) -> Phase:
        """Return the phase of the connection."""
        cycle = self.cycle
        # A connection that is kept alive waits for the next request.
        if cycle is None or cycle.response_complete:
            return Phase.REQUEST
        if cycle.more_body:
            return Phase.BODY
        return Phase.ANSWER if self.flow.write_paused else Phase.WORK

    def _make_room(self) -> None:
        """End the connection that has kept the server waiting longest, or this one."""
        is_crowded = len(self.connections) > self.most + self.extra
        # Every other connection is being answered, so the new one has to go.
        if not make_room(self.connections - {self}) and is_crowded:
            self.transport.abort()

    def _look(self) -> None:
        if self.transport.is_closing() or self.transport.get_protocol() is not self:
            return  # it has ended, or it is a WebSocket now
        phase, now = self.present_phase(), self.loop.time()
        # The time of a phase begins at the first check that sees it, at most
        # `LOOK_PERIOD` late.
        is_coming = phase is Phase.BODY and self.received >= LEAST_PART
        self.received = 0
        if phase is not self.phase or is_coming:
            self.phase, self.since = phase, now
        elif now - self.since > TIME_LIMITS.get(phase, now):
            self.transport.abort()
            return
        self.loop.call_later(LOOK_PERIOD, self._look)


class SocketProtocol(WebSocketsSansIOProtocol):
    """A WebSocket connection whose client's faults are no faults of the server."""

    @override
    def shutdown(self) -> None:
        # Uvicorn would close a client again that has just closed, and raise an error.
        if not self.transport.is_closing():
            super().shutdown()

    @override
    def send_receive_event_to_app(self) -> None:
        # Uvicorn would log a traceback for the client's fault, and close the connection
        # without a reason.
        if self.curr_msg_data_type == "text" and not self.close_sent:
            try:
                b"".join(self.frames).decode()
            except UnicodeDecodeError:
                self.frames = []
                self.conn.send_close(NO_UTF8, "a text has to be UTF-8")
                self.handle_parser_exception()
                return
        super().send_receive_event_to_app()


def make_room(connections: Iterable[asyncio.Protocol]) -> bool:
    """End the connection that has kept its server waiting longest.

    Args:
        connections: The connections of the server.

    Returns:
        Whether a connection was ended; connections at work are not.
    """
    # A transport that is closing already makes room.
    waiting: list[LimitedProtocol] = []
    for one in connections:
        if isinstance(one, WebSocketsSansIOProtocol):
            if one.close_sent and not one.transport.is_closing():
                one.transport.abort()  # the client does not answer the close frame
                return True
        elif (
            isinstance(one, LimitedProtocol)
            and not one.transport.is_closing()
            and one.present_phase() is not Phase.WORK
        ):
            waiting.append(one)
    if waiting:
        # End the connection that is longest in its phase: a slow client before a quick
        # one.
        min(waiting, key=lambda one: one.since).transport.abort()
    return bool(waiting)


_TWO_LENGTHS = PlainTextResponse(
    "A request has Content-Length or Transfer-Encoding, not both. Nothing was done.\n",
    400,
    {"connection": "close"},
)
"""Answer to a request that announces two lengths. A proxy in front of the server may
believe the other length, and take part of the body for the next request of another
client (RFC 9112, 6.3). So the connection ends, too."""


def _has_two_lengths(scope: Scope) -> bool:
    """Return whether a request announces the length of its body in two ways."""
    if scope["type"] != "http":
        return False
    names = {name for name, _ in scope["headers"]}
    return {b"content-length", b"transfer-encoding"} <= names


class LimitedServer(uvicorn.Server):
    """A server whose connections are limited in number and time.

    Args:
        config: Its configuration; this class sets the HTTP protocol and the backlog.
        most_connections: Most connections at a time; None takes as many as the
            descriptors of this process permit.
    """

    def __init__(
        self, config: uvicorn.Config, most_connections: int | None = None
    ) -> None:
        # Uvicorn takes a class, so the limits of this server are attributes of a class.
        class Protocol(LimitedProtocol):
            most = most_connections or connection_share()
            extra = EXTRA_CONNECTIONS if most > LEAST_CONNECTIONS else 2

        app = cast("ASGIApp", config.app)

        async def refusing(scope: Scope, receive: Receive, send: Send) -> None:
            answer: ASGIApp = _TWO_LENGTHS if _has_two_lengths(scope) else app
            await answer(scope, receive, send)

        config.app = cast("Any", refusing)
        config.http = Protocol
        is_tight = Protocol.most <= LEAST_CONNECTIONS
        # asyncio accepts as many connections in one turn as the backlog allows, before
        # any of them is counted.
        config.backlog = 2 if is_tight else ACCEPTED_AT_ONCE
        super().__init__(config)

    @override
    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, with a longer queue of waiting connections than asyncio sets."""
        asyncio.get_running_loop().set_exception_handler(self._on_trouble)
        await super().startup(sockets)
        # Set the queue again after uvicorn, so that connections wait in the operating
        # system instead of being refused.
        for listener in sockets or []:
            listener.listen(WAITING_CONNECTIONS)

    def _on_trouble(
        self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]
    ) -> None:
        """Make room when the process has no descriptor left for a connection.

        The event loop tries again to accept a connection after a second.
        """
        error = context.get("exception")
        # asyncio would try to accept again and again, and fill the log.
        if isinstance(error, OSError) and error.errno in _OUT_OF_FILES:
            for _ in range(ACCEPTED_AT_ONCE):
                make_room(self.server_state.connections)
            _log.warning(
                "No file can be opened any more, so the connections that have waited "
                "longest were ended: raise the limit (`ulimit -n`)."
            )
            return
        loop.default_exception_handler(context)


def connection_share(descriptors: int = 1) -> int:
    """Return the number of connections for which this process has file descriptors.

    Args:
        descriptors: How many descriptors a connection may take, >= 1.
    """
    limit, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    # The system has no limit, so only the station's own limit applies.
    if limit == resource.RLIM_INFINITY:
        return MOST_CONNECTIONS
    # Count also the connections that are accepted before others are ended for them.
    beyond = EXTRA_CONNECTIONS + ACCEPTED_AT_ONCE
    free = limit - len(os.listdir("/dev/fd")) - RESERVED_DESCRIPTORS - beyond
    return max(LEAST_CONNECTIONS, min(MOST_CONNECTIONS, free // descriptors))


def announces_more_than(scope: Scope, most: int) -> bool:
    """Return whether a request announces a body of more than `most` bytes.

    A length that is not a number counts as too large.
    """
    lengths = Headers(scope=scope).getlist("content-length")
    # A request may have several of these headers. A number of more than 18 digits is
    # too large, and need not be converted.
    return any(not n.isdecimal() or len(n) > 18 or int(n) > most for n in lengths)


def limited(receive: Receive, most: int, too_large: Exception) -> Receive:
    """Return a `receive` that raises an error when a body grows too large.

    Args:
        receive: The ASGI channel from which the body comes.
        most: Largest body [bytes].
        too_large: The error to raise.
    """
    size = 0

    async def receive_limited() -> Message:
        nonlocal size
        message = await receive()
        size += len(message.get("body", b""))
        # A body may be longer than announced, or come in chunks without a length.
        if size > most:
            raise too_large
        return message

    return receive_limited
