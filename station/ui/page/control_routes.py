"""Who holds control: shown, taken, handed over and given back from the page.

The station's answers name the lease to its holder. These routes take it out of them
and keep it in the gateway, so that no script of a page ever has it.
"""

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from station.client import ApiError, AsyncStationClient, StationUnreachableError
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import Role, Session

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from station.wire import ControlState

TTL = 10.0
"""How long control lasts after the page that holds it was closed or cut off [s]."""
BEAT_PERIOD = 3.0
"""Time between two heartbeats while a page of the holder is open [s]."""


class _Taking(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)
    owner: str = Field(default="", max_length=100)
    force: bool = False


class _Offer(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)
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
        find: "Callable[[Request], Session | None]",
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._access = access
        self._find = find
        self._now = now

    def routes(self) -> "list[BaseRoute]":
        """Return the routes."""
        path = "/workspace/control"
        return [
            Route(path, self._show),
            Route(path, self._take, methods=["POST"]),
            Route(path, self._offer, methods=["PATCH"]),
            Route(path, self._release, methods=["DELETE"]),
        ]

    async def keep(self, session: Session) -> None:
        """Send heartbeats while the session holds control; runs until cancelled.

        Whoever calls does so for as long as a page of the session is open.
        """
        while True:
            await asyncio.sleep(BEAT_PERIOD)
            await self.beat(session)

    async def beat(self, session: Session) -> None:
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

    async def _show(self, request: "Request") -> Response:
        return await self._answer(
            request, lambda client: client.lease.state(), may_watch=True
        )

    async def _take(self, request: "Request") -> Response:
        try:
            wanted = _Taking.model_validate_json(await request.body())
        except ValidationError as error:
            return _invalid(error)
        return await self._answer(
            request,
            lambda client: client.lease.take(
                wanted.owner or None, ttl=TTL, force=wanted.force
            ),
        )

    async def _offer(self, request: "Request") -> Response:
        try:
            wanted = _Offer.model_validate_json(await request.body())
        except ValidationError as error:
            return _invalid(error)
        return await self._answer(
            request,
            lambda client: client.lease.renew(hand_over_to=wanted.hand_over_to),
        )

    async def _release(self, request: "Request") -> Response:
        return await self._answer(request, lambda client: client.lease.release())

    async def _answer(
        self,
        request: "Request",
        ask: "Callable[[AsyncStationClient], Awaitable[ControlState]]",
        *,
        may_watch: bool = False,
    ) -> Response:
        session = self._find(request)
        if session is None:
            return refused(401, "no_session", "Log in first.")
        if session.role is not Role.OPERATOR and not may_watch:
            return refused(403, "forbidden", "Viewers only watch.")
        try:
            told = await self._ask(session, ask)
        except ApiError as error:
            return refused(error.status or 502, error.code, error.detail, error.remedy)
        return JSONResponse(told.model_dump(exclude={"lease"}))

    async def _ask(
        self,
        session: Session,
        ask: "Callable[[AsyncStationClient], Awaitable[ControlState]]",
    ) -> "ControlState":
        key, asked_at = self._access.lease_of(session), self._now()
        told = await ask(self._access.acting_for(session))
        self._access.note(session, told, key, asked_at)
        return told


def refused(status: int, code: str, detail: str, remedy: str = "") -> Response:
    """Return a refusal of the gateway, in the form of the station's.

    Args:
        status: HTTP status.
        code: For programs.
        detail: What is wrong.
        remedy: What to do; empty if nothing helps.
    """
    body = {"status": status, "code": code, "detail": detail, "remedy": remedy}
    return JSONResponse(body, status, media_type="application/problem+json")


def _invalid(error: ValidationError) -> Response:
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"])
    return refused(422, "invalid_request", f"{place}: {first['msg']}.")
