"""A web server whose clients can neither take its time nor its file descriptors.

A client that opens connections and says nothing, sends a header or a body drop by drop,
or does not read its answer, keeps a file descriptor. When a process has no descriptor
left, it accepts no connection, and nobody can stop the robot. So every step of a
request has a time limit, and the connections stay below the limit of descriptors: one
that comes when there are too many takes the place of the one that has waited longest
for its request. A stop sends its request at once and so is never that one.
"""

import asyncio
import os
import resource
import socket
from enum import Enum

import uvicorn
from typing_extensions import override
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import (
    WebSocketsSansIOProtocol,
)

MOST_CONNECTIONS = 256
"""Most connections at a time, WebSockets among them."""
RESERVED_DESCRIPTORS = 40
"""File descriptors that connections leave to the rest of the process."""
EXTRA_CONNECTIONS = 16
"""How many more are taken when every connection is at work, so that a stop gets in."""
ACCEPTED_AT_ONCE = 8
"""Connections accepted in one turn of the event loop; counted only after the turn."""
WAITING_CONNECTIONS = 1024
"""Connections that the system keeps until they are accepted."""
LOOK_PERIOD = 0.5
"""How often a connection is looked at [s]."""


class Phase(Enum):
    """What a connection is busy with."""

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


class LimitedProtocol(H11Protocol):
    """One HTTP connection.

    Attributes:
        most: Most connections of the server at a time.
        phase: What the connection is busy with, as far as it has been looked at.
        since: When that phase began [s, clock of the event loop].
    """

    most = MOST_CONNECTIONS
    phase = Phase.REQUEST
    since = 0.0

    @override
    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn has it
        super().connection_made(transport)
        self.since = self.loop.time()
        if len(self.connections) > self.most:
            self._make_room()
        self.loop.call_later(LOOK_PERIOD, self._look)

    @override
    def on_response_complete(self) -> None:
        super().on_response_complete()
        self.phase, self.since = Phase.REQUEST, self.loop.time()

    def present_phase(self) -> Phase:
        """Return what the connection is busy with."""
        cycle = self.cycle
        if cycle is None or cycle.response_complete:
            return Phase.REQUEST
        if cycle.more_body:
            return Phase.BODY
        return Phase.ANSWER if self.flow.write_paused else Phase.WORK

    def _make_room(self) -> None:
        """End the connection that has kept the server waiting longest."""
        # Where the transport is closing, the place is given away already.
        others = [
            one
            for one in self.connections
            if one is not self and not one.transport.is_closing()
        ]
        waiting = [
            one
            for one in others
            if isinstance(one, LimitedProtocol)
            and one.present_phase() is not Phase.WORK
        ]
        closed = [
            one
            for one in others
            if isinstance(one, WebSocketsSansIOProtocol) and one.close_sent
        ]
        if closed:  # the client does not answer the close frame
            closed[0].transport.abort()
        elif waiting:
            min(waiting, key=lambda one: one.since).transport.abort()
        elif len(self.connections) > self.most + EXTRA_CONNECTIONS:
            self.transport.abort()

    def _look(self) -> None:
        if self.transport.is_closing() or self.transport.get_protocol() is not self:
            return  # it has ended, or it is a WebSocket now
        phase, now = self.present_phase(), self.loop.time()
        if phase is not self.phase:
            self.phase, self.since = phase, now
        elif now - self.since > TIME_LIMITS.get(phase, now):
            self.transport.abort()
            return
        self.loop.call_later(LOOK_PERIOD, self._look)


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
        class Protocol(LimitedProtocol):
            most = most_connections or connection_share()

        config.http = Protocol
        config.backlog = ACCEPTED_AT_ONCE
        super().__init__(config)

    @override
    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen; the system may keep more connections than are accepted at once."""
        await super().startup(sockets)
        for listener in sockets or []:
            listener.listen(WAITING_CONNECTIONS)


def connection_share(descriptors: int = 1) -> int:
    """Return how many connections leave enough file descriptors to this process.

    Args:
        descriptors: How many descriptors a connection may take, >= 1.
    """
    limit, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if limit == resource.RLIM_INFINITY:
        return MOST_CONNECTIONS
    free = limit - len(os.listdir("/dev/fd")) - RESERVED_DESCRIPTORS
    return max(ACCEPTED_AT_ONCE, min(MOST_CONNECTIONS, free // descriptors))
