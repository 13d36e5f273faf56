"""Show, take, hand over and give back control from the page.

The station's answers to the holder contain the lease. These routes take the lease out
and keep it in the gateway, so that no script of a page ever has it.
"""

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

from pydantic import Field
from starlette.responses import JSONResponse, Response

from station.client import ApiError, AsyncStationClient, StationUnreachableError
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.session_routes import Body, FindSession, SessionRoutes

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from station.ui.sessions.sessions import Session
    from station.wire import ControlState

TTL = 10.0
"""Time for which control lasts after its page was closed or cut off [s]."""
BEAT_PERIOD = 3.0
"""Time between two heartbeats while a page of the holder is open [s]."""


class _Taking(Body):
    owner: str = Field(default="", max_length=100)
    force: bool = False


class _Offer(Body):
    hand_over_to: str = Field(min_length=1, max_length=100)


class ControlRoutes:
    """The routes `/workspace/control`.

    Args:
        access: The credentials of the sessions.
        find: Returns the session of a request, or None.
        now: Monotonic clock [s].
    """

    def __init__(
        self,
        access: SessionAccess,
        find: FindSession,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._access = access
        self._find = find
        self._now = now

    def routes(self) -> "list[BaseRoute]":
        """Return the routes."""
        path, make = "/workspace/control", SessionRoutes(self._find)
        return [
            make.route("GET", path, self._show),
            make.route_of("POST", path, _Taking, self._take, operators_only=True),
            make.route_of("PATCH", path, _Offer, self._offer, operators_only=True),
            make.route("DELETE", path, self._release, operators_only=True),
        ]

    async def keep(self, session: "Session") -> None:
        """Send heartbeats while the session holds control; runs until cancelled.

        Call it while a page of the session is open.
        """
        while True:
            await asyncio.sleep(BEAT_PERIOD)
            await self.beat(session)

    async def beat(self, session: "Session") -> None:
        """Send one heartbeat if the session holds control; note when it is lost."""
        key = self._access.lease_of(session)
        if key is None:
            return
        try:
            await self._ask(session, lambda client: client.lease.renew())
        except StationUnreachableError:
            return  # The link may come back before the lease is over.
        except ApiError:
            self._access.lose(key)

    async def _show(self, session: "Session", _request: "Request") -> Response:
        return await self._answer(session, lambda client: client.lease.state())

    async def _take(self, session: "Session", wanted: _Taking) -> Response:
        owner, force = wanted.owner or None, wanted.force
        return await self._answer(
            session, lambda client: client.lease.take(owner, ttl=TTL, force=force)
        )

    async def _offer(self, session: "Session", wanted: _Offer) -> Response:
        to = wanted.hand_over_to
        return await self._answer(
            session, lambda client: client.lease.renew(hand_over_to=to)
        )

    async def _release(self, session: "Session", _request: "Request") -> Response:
        return await self._answer(session, lambda client: client.lease.release())

    async def _answer(
        self,
        session: "Session",
        ask: "Callable[[AsyncStationClient], Awaitable[ControlState]]",
    ) -> Response:
        state = await self._ask(session, ask)
        # No script of a page may have the lease: it would act beside the dashboard.
        return JSONResponse(state.model_dump(exclude={"lease"}))

    async def _ask(
        self,
        session: "Session",
        ask: "Callable[[AsyncStationClient], Awaitable[ControlState]]",
    ) -> "ControlState":
        key, asked_at = self._access.lease_of(session), self._now()
        state = await ask(self._access.acting_for(session))
        self._access.note(session, state, key, asked_at)
        return state
