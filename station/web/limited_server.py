"""A web server whose clients can neither take its time nor its file descriptors.

A client that opens connections and says nothing, sends a header or a body drop by drop,
or does not read its answer, keeps a file descriptor. When a process has no descriptor
left, it accepts no connection, and no client can stop the robot. So every step of a
request has a time limit, and the connections stay below the limit of descriptors: one
that comes when there are too many takes the place of the one that has waited longest
for its request. A stop sends its request at once and so is never that one.
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
"""File descriptors that connections leave to the rest of the process."""
EXTRA_CONNECTIONS = 16
"""How many more are taken when every connection is at work, so that a stop gets in."""
ACCEPTED_AT_ONCE = 8
"""Connections accepted in one turn of the event loop; counted only after the turn."""
LEAST_CONNECTIONS = 4
"""Most connections of a process that may hardly open any file; the others of these
numbers are two then."""
WAITING_CONNECTIONS = 1024
"""Connections that the system keeps until they are accepted."""
LOOK_PERIOD = 0.5
"""How often a connection is looked at [s]."""


_OUT_OF_FILES = frozenset({errno.EMFILE, errno.ENFILE})
_log = logging.getLogger(__name__)


class Phase(Enum):
    """Phase of a connection."""

    REQUEST = "request"
    """Nothing, or the header of the next request arrives."""
    BODY = "body"
    """The body of a request arrives."""
    WORK = "work"
    """The request is being answered."""
    ANSWER = "answer"
    """The client has to read its answer before more can be sent."""


TIME_LIMITS = {Phase.REQUEST: 5.0, Phase.BODY: 10.0, Phase.ANSWER: 10.0}
"""How long a phase may last [s]; work may take any time."""
LEAST_PART = 16 * 1024
"""Bytes of a body between two looks, with which its time begins anew: a large file may
take its time, drops may not."""


class LimitedProtocol(H11Protocol):
    """One HTTP connection.

    Attributes:
        most: Most connections of the server at a time.
        extra: How many more are taken when all of those are at work.
        phase: State of the connection when it was last looked at.
        since: When that phase began [s, clock of the event loop].
        received: Bytes that have come since the last look.
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
        # A new connection is let in first: it may be the one that asks for a stop.
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
        # The time of a phase begins when it is first seen, at most `LOOK_PERIOD` late.
        is_coming = phase is Phase.BODY and self.received >= LEAST_PART
        self.received = 0
        if phase is not self.phase or is_coming:
            self.phase, self.since = phase, now
        elif now - self.since > TIME_LIMITS.get(phase, now):
            self.transport.abort()
            return
        self.loop.call_later(LOOK_PERIOD, self._look)


def make_room(connections: Iterable[asyncio.Protocol]) -> bool:
    """End the connection that has kept its server waiting longest.

    Args:
        connections: The connections of the server.

    Returns:
        Whether there was one; those at work are not ended.
    """
    # Where the transport is closing, the place is given away already.
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
        # The longest in its phase: a slow client loses before a quick one.
        min(waiting, key=lambda one: one.since).transport.abort()
    return bool(waiting)


_TWO_LENGTHS = PlainTextResponse(
    "A request has Content-Length or Transfer-Encoding, not both. Nothing was done.\n",
    400,
    {"connection": "close"},
)
"""A proxy before the server may believe the other one, and so take a part of the body
for the next request of somebody else (RFC 9112, 6.3). So the connection ends, too."""


def _has_two_lengths(scope: Scope) -> bool:
    """Return whether a request announces the length of its body in two ways."""
    if scope["type"] != "http":
        return False
    names = {name for name, _ in scope["headers"]}
    return {b"content-length", b"transfer-encoding"} <= names


class LimitedServer(uvicorn.Server):
    """A server whose connections are limited in number and time.

    Args:
        config: Its configuration; how HTTP is spoken is decided here.
        most_connections: Most connections at a time; what the descriptors of this
            process permit when None.
    """

    def __init__(
        self, config: uvicorn.Config, most_connections: int | None = None
    ) -> None:
        # Uvicorn takes a class, so the limits of this server are attributes of one.
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
        # asyncio accepts as many connections at once as the backlog has, before any is
        # counted.
        config.backlog = 2 if is_tight else ACCEPTED_AT_ONCE
        super().__init__(config)

    @override
    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen; the system may keep more connections than are accepted at once."""
        asyncio.get_running_loop().set_exception_handler(self._on_trouble)
        await super().startup(sockets)
        # Set anew after uvicorn: connections wait in the system instead of being
        # refused.
        for listener in sockets or []:
            listener.listen(WAITING_CONNECTIONS)

    def _on_trouble(
        self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]
    ) -> None:
        """Make room when the process has no descriptor left for a connection.

        The event loop tries again to accept one after a second.
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
    """Return the number of connections that leaves this process file descriptors.

    Args:
        descriptors: How many descriptors a connection may take, >= 1.
    """
    limit, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    # No limit of the system; the station's own one holds.
    if limit == resource.RLIM_INFINITY:
        return MOST_CONNECTIONS
    # What is accepted beyond the share, before one is ended for it, counts, too.
    beyond = EXTRA_CONNECTIONS + ACCEPTED_AT_ONCE
    free = limit - len(os.listdir("/dev/fd")) - RESERVED_DESCRIPTORS - beyond
    return max(LEAST_CONNECTIONS, min(MOST_CONNECTIONS, free // descriptors))


def announces_more_than(scope: Scope, most: int) -> bool:
    """Return whether a request announces a body of more than `most` bytes.

    A length that is not a number counts as one that is too large.
    """
    lengths = Headers(scope=scope).getlist("content-length")
    # Of several headers each counts. Longer numbers would take time to convert.
    return any(not n.isdecimal() or len(n) > 18 or int(n) > most for n in lengths)


def limited(receive: Receive, most: int, too_large: Exception) -> Receive:
    """Return a `receive` that raises when a body without a length grows too large.

    Args:
        receive: Channel by which the server hands the body over.
        most: Largest body [bytes].
        too_large: Error of a body that is too large.
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
