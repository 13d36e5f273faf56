"""A port of its own for Foxglove, behind the same door as the API.

The server of the API listens there, too, so that Host and Origin, tokens, the lease and
the limits of connections are judged by the same code. Without a token a client on this
machine is a viewer: Foxglove asks for an address alone.
"""

import asyncio
import logging
from collections.abc import Iterable
from typing import TYPE_CHECKING

from fastapi import FastAPI
from starlette.datastructures import URL
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from station.api.audit import note_access
from station.api.auth import Access, Role
from station.api.errors import ProblemError
from station.api.foxglove.foxglove_changes import FoxgloveChanges
from station.api.foxglove.foxglove_session import SUBPROTOCOLS, FoxgloveSession
from station.api.foxglove.live_channels import LiveChannels
from station.api.guard import Guard
from station.api.host_policy import HostPolicy
from station.api.services import Services, services_of
from station.api.streams.broadcaster import CLOSE_INTERNAL_ERROR, PORT, first_end
from station.wire import (
    CLOSE_BAD_REQUEST,
    CLOSE_GOING_AWAY,
    CLOSE_TOO_SLOW,
    CLOSE_TRY_LATER,
    CLOSE_UNAUTHORIZED,
)
from station.wire.protocol import LEASE_HEADER

if TYPE_CHECKING:
    from station.api.streams.stream_client import StreamPort

RATE = 50.0
"""Cycles per second that are sent [Hz wall time]."""
MOST_CLIENTS = 16
"""Most clients at a time; viewers get three quarters of them."""
SLOW_AFTER = 5.0
"""A client that takes nothing for so long is closed [s]."""
_PARAMETERS_EVERY = 25
"""Ticks between two looks whether gains have changed."""

_log = logging.getLogger(__name__)


class FoxglovePort:
    """An application for one port: WebSockets in the words of Foxglove.

    Args:
        app: The application of the API, whose station, tokens and lease it shares.
        channels: Channels that a client can subscribe to.
        host: Address to listen at.
        port: TCP port; 0 for any free one.
        policy: Which hosts and origins are allowed.
        anonymous: Whether a client without a token is a viewer.
    """

    def __init__(
        self,
        app: FastAPI,
        channels: LiveChannels,
        *,
        host: str,
        port: int,
        policy: HostPolicy,
        anonymous: bool,
    ) -> None:
        self.host = host
        self.port = port
        self._app = app
        self._channels = channels
        self._anonymous = anonymous
        self._numbers: dict[str, int] = {}
        self._sessions: dict[FoxgloveSession, Access] = {}
        self._ticking: asyncio.Task[None] | None = None
        self._guarded: ASGIApp = Guard(self._serve, policy)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request or a WebSocket."""
        await self._guarded(scope, receive, send)

    async def tick(self) -> None:
        """Offer the newest cycle to the subscribers."""
        wanted = {topic for session in self._sessions for topic in session.topics}
        messages = self._channels.newest(wanted)
        for session in self._sessions:
            session.offer(messages)

    async def _serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        scope["app"] = self._app
        scope.setdefault("state", {})
        if scope["type"] != "websocket":
            refused = ProblemError(
                426,
                "websocket_needed",
                "This port speaks the protocol of Foxglove, over WebSockets alone.",
                f"Open {URL(scope=scope).replace(scheme='ws', path='/')} in Foxglove.",
                {"Upgrade": "websocket", "Connection": "Upgrade"},
            )
            await refused.response()(scope, receive, send)
            return
        websocket = WebSocket(scope, receive, send)
        offered = scope.get("subprotocols", [])
        chosen = next((one for one in SUBPROTOCOLS if one in offered), None)
        await websocket.accept(chosen)
        access = await self._access(websocket)
        if access is None:
            reason = "The token or ticket is missing, unknown, revoked or too old."
            await websocket.close(CLOSE_UNAUTHORIZED, reason)
        elif chosen is None:
            names = " or ".join(SUBPROTOCOLS)
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
            found = Access(Role.VIEWER) if self._anonymous else None
        if found is not None:
            note_access(websocket, found)
        elif token is not None or "authorization" in websocket.headers:
            services.event_recorder.failed_login(websocket)
            await services.failed_logins.slow_down(websocket)
        return found

    def _refusal(self, access: Access) -> str | None:
        """Return the reason for refusing another client; None when it is accepted."""
        if len(self._sessions) >= MOST_CLIENTS:
            return f"there are {MOST_CLIENTS} clients already"
        share = MOST_CLIENTS - MOST_CLIENTS // 4
        viewers = sum(one.role is Role.VIEWER for one in self._sessions.values())
        if access.role is Role.VIEWER and viewers >= share:
            return f"there are {share} viewers already"
        return None

    async def _talk(self, websocket: WebSocket, access: Access) -> None:
        services = services_of(websocket)
        lease = websocket.query_params.get("lease")
        lease = lease or websocket.headers.get(LEASE_HEADER)
        changes = FoxgloveChanges(websocket, access, lease)
        session = FoxgloveSession(websocket, self._channels, changes, self._numbers)
        self._channels.newest(())  # so that its channels can be advertised
        self._sessions[session] = access
        if self._ticking is None or self._ticking.done():
            self._ticking = asyncio.create_task(self._tick_forever())
        try:
            await session.greet(services.station.boot_id)
            code, reason = await self._first_end(session, access, self._ticking)
        except WebSocketDisconnect:
            return
        finally:
            del self._sessions[session]
            if not self._sessions and self._ticking is not None:
                self._ticking.cancel()
                self._ticking = None
        if code:
            stream_port: StreamPort = websocket.scope["state"][PORT]
            stream_port.abort(code, reason)

    async def _first_end(
        self, session: FoxgloveSession, access: Access, ticking: asyncio.Task[None]
    ) -> tuple[int, str]:
        """Return the closing code and reason: (0, "") if the client is gone already."""
        services: Services = self._app.state.services
        ends = [
            (session.listen(), 0, ""),
            (session.feed(SLOW_AFTER), CLOSE_TOO_SLOW, "took no message in time"),
            (
                services.broadcaster.wait_closing(),
                CLOSE_GOING_AWAY,
                "the station shuts down",
            ),
            (access.wait_for_end(), CLOSE_UNAUTHORIZED, "the token has ended"),
            (_end_of(ticking), CLOSE_INTERNAL_ERROR, "no more cycles are sent"),
        ]
        return await first_end(ends, "a Foxglove client's connection")

    async def _tick_forever(self) -> None:
        loop = asyncio.get_running_loop()
        deadline, ticks = loop.time(), 0
        while True:
            await self.tick()
            ticks += 1
            if ticks % _PARAMETERS_EVERY == 0:
                await self._watch_parameters(tuple(self._sessions))
            deadline = max(deadline + 1.0 / RATE, loop.time())
            await asyncio.sleep(deadline - loop.time())

    async def _watch_parameters(self, sessions: Iterable[FoxgloveSession]) -> None:
        for session in sessions:
            try:
                async with asyncio.timeout(1.0):
                    await session.watch_parameters()
            except (TimeoutError, WebSocketDisconnect, RuntimeError):
                continue  # slow or gone; its own task ends it


async def _end_of(task: asyncio.Task[None]) -> None:
    await asyncio.shield(task)


def by_port(app: ASGIApp, foxglove: FoxglovePort) -> ASGIApp:
    """Return an application that tells the two by the port that was connected to."""

    async def serve(scope: Scope, receive: Receive, send: Send) -> None:
        server = scope.get("server")
        is_foxglove = server is not None and server[1] == foxglove.port
        await (foxglove if is_foxglove else app)(scope, receive, send)

    return serve
