"""Ports for tools with their own protocol, with the same access rules as the API.

The API's server also listens at these ports, so the same code checks Host and Origin,
tokens, the lease and the limits of connections. A client on this machine without a
token is a viewer, because such tools ask users only for an address.
"""

import asyncio
import logging
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, TypeVar

from fastapi import FastAPI
from starlette.datastructures import URL
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from station.api.audit import note_access, origin_of
from station.api.auth import Access, Role
from station.api.errors import ProblemError
from station.api.guard import Guard
from station.api.services import services_of
from station.api.streams.broadcaster import CLOSE_INTERNAL_ERROR, PORT, first_end
from station.core.errors import StationError
from station.events import EventKind, Origin, Severity
from station.web.host_policy import HostPolicy
from station.wire import (
    CLOSE_BAD_REQUEST,
    CLOSE_GOING_AWAY,
    CLOSE_TOO_SLOW,
    CLOSE_TRY_LATER,
    CLOSE_UNAUTHORIZED,
)
from station.wire.protocol import LEASE_HEADER

if TYPE_CHECKING:
    from station.api.streams.channel import StreamPort

_log = logging.getLogger(__name__)
SLOW_AFTER = 5.0
"""Time without reading after which a client is closed [s]."""


class ChangeRefusedError(StationError, PermissionError):
    """A client has requested a change that it may not make."""

    code = "change_refused"


def report_fault(error: Exception) -> str:
    """Log a fault of the station; return the words for the client that met it.

    Args:
        error: What was raised although the client's message is in order.
    """
    _log.error("a message of a client could not be carried out", exc_info=error)
    return (
        f"The station failed unexpectedly: {type(error).__name__}. Its log has the "
        "traceback; please report it."
    )


def reason_of(error: StationError) -> str:
    """Return the words for a client whose change was refused."""
    return f"{error.message} {error.remedy}".strip()


class ToolClient:
    """A client of a port: its rights, and the events about its changes.

    Args:
        tool: Name of the tool, for events.
        websocket: Its connection.
        access: Rights of the client.
        lease: The lease of control that the client names; None without one.

    Attributes:
        websocket: As given.
        access: Rights of the client; it may prove other rights later.
        lease: As given.
        services: The services of the application.
    """

    def __init__(
        self, tool: str, websocket: WebSocket, access: Access, lease: str | None
    ) -> None:
        self.websocket = websocket
        self.access = access
        self.lease = lease
        self.services = services_of(websocket)
        self._tool = tool

    def check(self, what: str) -> None:
        """Refuse a change that the client may not make.

        Args:
            what: The change, for the event of a refusal.

        Raises:
            ChangeRefusedError: The client is not, or no longer, an operator.
            StationError: Another client holds control.
        """
        try:
            if self.access.has_ended():
                raise ChangeRefusedError(
                    "The token of this connection has been revoked or has expired.",
                    remedy="Connect with another token.",
                )
            if not self.access.role.includes(Role.OPERATOR):
                who = "An agent" if self.access.role is Role.AGENT else "A viewer"
                raise ChangeRefusedError(
                    f"{who} may look, but not change anything over {self._tool}.",
                    remedy="Connect with ?token=… of an operator.",
                )
            self.services.control.check(self.access, self.lease)
        except StationError as error:
            self.record(what, f"refused: {error.code}", is_done=False)
            raise

    @contextmanager
    def changing(
        self, what: str, *, changes: bool = True, free: int = 10
    ) -> Iterator[None]:
        """Check that the client may make a change, and record how the body ends.

        Args:
            what: The change.
            changes: Whether it changes the station; otherwise this does nothing.
            free: As in `record`.

        Raises:
            StationError: The client may not make changes, or the body refused it.
        """
        if not changes:
            yield
            return
        self.check(what)
        try:
            yield
        except StationError as error:
            self.record(what, f"refused: {error.code}", is_done=False)
            raise
        self.record(what, "done", is_done=True, free=free)

    def record(self, what: str, result: str, *, is_done: bool, free: int = 10) -> None:
        """Record a change that was carried out or refused, and count repeats.

        Args:
            what: The change.
            result: Result of the change, in one or two words.
            is_done: Whether it was carried out.
            free: Number of such events that are recorded singly; later ones are
                counted.
        """
        found = origin_of(self.websocket)
        who = self.services.control.name_of(self.access, self.lease)
        ended = "was carried out" if is_done else f"was {result}"
        self.services.event_recorder.repeats.record(
            EventKind.REQUEST,
            f"{self._tool}'s {what} of {who} {ended}.",
            severity=Severity.INFO if is_done else Severity.WARNING,
            what=f"{self._tool.lower()} {what}",
            result=result,
            origin=Origin(who, found.where, found.request_id),
            free=free,
        )


class ToolSession(Protocol):
    """The conversation with one client, in the event loop of the API."""

    async def greet(self) -> None:
        """Send the first messages of the protocol."""

    async def feed(self, slow_after: float) -> None:
        """Send waiting messages; return if the client reads none for too long."""

    async def listen(self) -> None:
        """Answer the client's messages; return when the client has left."""


SessionT = TypeVar("SessionT", bound=ToolSession)


@dataclass(frozen=True, slots=True)
class Place:
    """The address at which a tool is served, and the clients that are admitted.

    Attributes:
        host: Address to listen at.
        port: TCP port; 0 for any free one.
        policy: Allowed hosts and origins.
        anonymous: Whether a client without a token is a viewer.
    """

    host: str
    port: int
    policy: HostPolicy
    anonymous: bool


class ToolPort(ABC, Generic[SessionT]):
    """The application at one tool port, which speaks the tool's protocol.

    Args:
        app: The application of the API, whose station, tokens and lease it shares.
        place: Address of the port, and the clients that it admits.

    Attributes:
        place: As given.
        host: Address to listen at.
        port: TCP port; the true one after the server listens.
        sessions: The conversations, with the client of each.
    """

    tool: ClassVar[str]
    """Name of the tool, for people."""
    subprotocols: ClassVar[tuple[str, ...]] = ()
    """WebSocket subprotocols, one of which a client must offer; empty for none."""
    rate: ClassVar[float]
    """Ticks per second [Hz wall time]."""
    most_clients: ClassVar[int]
    """Most clients at a time; viewers may have three quarters of them."""

    def __init__(self, app: FastAPI, place: Place) -> None:
        self.place = place
        self.host, self.port = place.host, place.port
        self._app = app
        self.sessions: dict[SessionT, Access] = {}
        self._ticking: asyncio.Task[None] | None = None
        self._guarded: ASGIApp = Guard(self._serve, place.policy)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request or a WebSocket."""
        await self._guarded(scope, receive, send)

    @abstractmethod
    def open(self, client: ToolClient) -> SessionT:
        """Begin the conversation with an accepted client."""

    @abstractmethod
    async def tick(self) -> None:
        """Offer the newest cycle to the clients."""

    async def _serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        scope["app"] = self._app
        scope.setdefault("state", {})
        if scope["type"] != "websocket":
            refused = ProblemError(
                426,
                "websocket_needed",
                f"This port speaks the protocol of {self.tool}, over WebSockets alone.",
                f"Open {URL(scope=scope).replace(scheme='ws', path='/')} in "
                f"{self.tool}.",
                {"Upgrade": "websocket", "Connection": "Upgrade"},
            )
            await refused.response()(scope, receive, send)
            return
        websocket = WebSocket(scope, receive, send)
        offered = scope.get("subprotocols", [])
        chosen = next((one for one in self.subprotocols if one in offered), None)
        await websocket.accept(chosen)
        access = await self._access(websocket)
        if access is None:
            reason = "The token or ticket is missing, unknown, revoked or too old."
            await websocket.close(CLOSE_UNAUTHORIZED, reason)
        elif chosen is None and self.subprotocols:
            names = " or ".join(self.subprotocols)
            await websocket.close(CLOSE_BAD_REQUEST, f"The subprotocol is {names}.")
        elif (refusal := self._refusal(access)) is not None:
            await websocket.close(CLOSE_TRY_LATER, refusal)
        else:
            await self._talk(websocket, access)

    async def _access(self, websocket: WebSocket) -> Access | None:
        """Return the access of a client; None if its token is wrong."""
        services = services_of(websocket)
        authenticator = services.authenticator
        ticket = websocket.query_params.get("ticket")
        token = websocket.query_params.get("token")
        if ticket is not None:
            found = authenticator.redeem_ticket(ticket)
        elif token is not None:
            found = authenticator.access_of_token(token)
        elif "authorization" in websocket.headers:
            found = authenticator.access_of_headers(websocket.headers)
        else:
            found = Access(Role.VIEWER) if self.place.anonymous else None
        if found is not None:
            note_access(websocket, found)
        elif token is not None or "authorization" in websocket.headers:
            services.event_recorder.failed_login(websocket)
            await services.failed_logins.slow_down(websocket)
        return found

    def _refusal(self, access: Access) -> str | None:
        """Return the reason for refusing another client; None if it is accepted."""
        most = self.most_clients
        if len(self.sessions) >= most:
            return f"there are {most} clients already"
        share = most - most // 4
        viewers = sum(one.role is Role.VIEWER for one in self.sessions.values())
        if access.role is Role.VIEWER and viewers >= share:
            return f"there are {share} viewers already"
        return None

    async def _talk(self, websocket: WebSocket, access: Access) -> None:
        lease = websocket.query_params.get("lease")
        lease = lease or websocket.headers.get(LEASE_HEADER)
        client = ToolClient(self.tool, websocket, access, lease)
        session = self.open(client)
        self.sessions[session] = access
        if self._ticking is None or self._ticking.done():
            self._ticking = asyncio.create_task(self._tick_forever())
        try:
            await session.greet()
            code, reason = await self._first_end(session, client, self._ticking)
        except WebSocketDisconnect:
            return
        finally:
            del self.sessions[session]
            if not self.sessions and self._ticking is not None:
                self._ticking.cancel()
                self._ticking = None
        if code:
            stream_port: StreamPort = websocket.scope["state"][PORT]
            stream_port.abort(code, reason)

    async def _first_end(
        self, session: SessionT, client: ToolClient, ticking: asyncio.Task[None]
    ) -> tuple[int, str]:
        """Return the closing code and reason; (0, "") if the client has left."""
        closing = client.services.broadcaster.wait_closing
        ends = [
            (session.listen(), 0, ""),
            (session.feed(SLOW_AFTER), CLOSE_TOO_SLOW, "took no message in time"),
            (closing(), CLOSE_GOING_AWAY, "the station shuts down"),
            (client.access.wait_for_end(), CLOSE_UNAUTHORIZED, "the token has ended"),
            (_end_of(ticking), CLOSE_INTERNAL_ERROR, "no more cycles are sent"),
        ]
        return await first_end(ends, f"the connection of a client of {self.tool}")

    async def _tick_forever(self) -> None:
        loop = asyncio.get_running_loop()
        deadline = loop.time()
        while True:
            await self.tick()
            deadline = max(deadline + 1.0 / self.rate, loop.time())
            await asyncio.sleep(deadline - loop.time())


async def _end_of(task: asyncio.Task[None]) -> None:
    await asyncio.shield(task)


def by_port(app: ASGIApp, ports: Sequence[ToolPort[Any]]) -> ASGIApp:
    """Return an application that calls the application of a connection's port."""

    async def serve(scope: Scope, receive: Receive, send: Send) -> None:
        server = scope.get("server")
        number = None if server is None else server[1]
        found: Iterable[ASGIApp] = (one for one in ports if one.port == number)
        await next(iter(found), app)(scope, receive, send)

    return serve
