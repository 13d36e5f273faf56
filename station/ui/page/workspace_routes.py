"""Requests of the page that the dashboard answers itself, those of control among them.

The station's answers to the holder of control contain the lease. The routes take the
lease out and keep it in the gateway, so that no script of a page ever has it.
"""

import asyncio
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import anyio
import anyio.to_thread
import yaml
from pydantic import Field, JsonValue, ValidationError
from starlette.responses import JSONResponse, Response
from starlette.routing import WebSocketRoute

from station.client import ApiError, AsyncStationClient, StationUnreachableError
from station.core.errors import ConfigError
from station.core.yaml_reader import FORM, parse_yaml
from station.ui.link.station_view import StationView
from station.ui.page.controller_offers import example_parameters, suggested_name
from station.ui.page.page_state import page_state
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import (
    Body,
    BrowserSession,
    FindSession,
    RefusedError,
    Role,
    SessionRoutes,
    Sessions,
)
from station.ui.teleoperation.joint_teleoperation import Movers
from station.ui.teleoperation.teleoperation import Teleoperation
from station.ui.teleoperation.teleoperation_socket import TeleoperationSocket

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute
    from starlette.websockets import WebSocket

    from station.wire import ControlState

_T = TypeVar("_T")
_NOT_LOGGED_IN = 4401
_FORBIDDEN = 4403
TTL = 10.0
"""Time for which control lasts after its page was closed or cut off [s]."""
BEAT_PERIOD = 3.0
"""Time between two heartbeats while a page of the holder is open [s]."""


class _Parameters(Body):
    """Parameters of a controller, as the fields of the page have them."""

    params: dict[str, JsonValue]


@dataclass(frozen=True, slots=True)
class WorkspaceParts:
    """The parts of the dashboard that the docks need.

    Attributes:
        view: Returns the dashboard's knowledge of the station; callable by any thread.
        access: The credentials of the sessions at the station.
        triangles: How many triangles the drawn robots have.
        not_drawn: Why no robot is drawn; empty when there is no such reason.
        movers: The mover of each joint, shared by all that command joints.
    """

    view: Callable[[], StationView]
    access: SessionAccess
    triangles: int = 0
    not_drawn: str = ""
    movers: Movers = field(default_factory=Movers)


class WorkspaceRoutes:
    """The routes below `/workspace`.

    Args:
        parts: Parts of the dashboard that the docks need.
        sessions: The logged-in browsers.
        find: Returns the session of a connection.
    """

    def __init__(
        self, parts: WorkspaceParts, sessions: Sessions, find: FindSession
    ) -> None:
        self._parts = parts
        self._sessions = sessions
        self._find = find
        self._control = ControlRoutes(parts.access, find)
        # One text at a time: parsing YAML holds the interpreter, and STOP shares it.
        self._one_text = anyio.CapacityLimiter(1)

    def routes(self) -> "list[BaseRoute]":
        """Return the routes."""
        make = SessionRoutes(self._find)
        read, write = "/workspace/parameters", "/workspace/yaml"
        return [
            make.route("GET", "/workspace/state", self._state),
            make.route("GET", "/workspace/example", self._example),
            # Only operators load controllers.
            make.route("POST", read, self._read_yaml, operators_only=True),
            make.route("POST", write, self._write_yaml, operators_only=True),
            WebSocketRoute("/workspace/teleoperation", self._teleoperate),
            *self._control.routes(),
        ]

    async def _state(self, _session: BrowserSession, _request: "Request") -> Response:
        drawing = {
            "triangles": self._parts.triangles,
            "not_drawn": self._parts.not_drawn,
        }
        return JSONResponse({**page_state(self._parts.view()), **drawing})

    async def _example(self, _session: BrowserSession, request: "Request") -> Response:
        """Answer a free name, and parameters with which a type loads on this robot."""
        kind = request.query_params.get("type", "")
        view = self._parts.view()
        arm = request.query_params.get("arm", "")
        text = example_parameters(kind, view.positions, arm)
        return JSONResponse({
            "name": suggested_name(kind, (c.name for c in view.controllers)),
            "yaml": text,
            "params": parse_yaml(text, "Example", FORM).values,
        })

    async def _read_yaml(
        self, _session: BrowserSession, request: "Request"
    ) -> Response:
        """Answer the parameters that a text in YAML means.

        Raises:
            RefusedError: The text is not valid; the refusal says where.
        """
        text = (await request.body()).decode("utf-8", errors="replace")
        try:
            read = await self._aside(lambda: parse_yaml(text, "Parameters", FORM))
        except ConfigError as error:
            raise RefusedError(
                422, "invalid_yaml", error.message, error.remedy
            ) from error
        try:
            return JSONResponse({"params": read.values})
        except ValueError as error:
            detail = "A number is infinite or none; JSON has finite numbers alone."
            raise RefusedError(422, "invalid_yaml", detail) from error

    async def _write_yaml(
        self, _session: BrowserSession, request: "Request"
    ) -> Response:
        """Answer parameters, the JSON under `params`, as a text in YAML.

        Raises:
            RefusedError: The body is too large, or has no such parameters.
        """
        body = await request.body()
        # A longer text could not be read back, and STOP waits while it is written.
        if len(body) > FORM.characters:
            detail = f"The parameters have more than {FORM.characters} characters."
            raise RefusedError(413, "body_too_large", detail, "Shorten them.")
        try:
            params = _Parameters.model_validate_json(body).params
        except ValidationError as error:
            detail = "The body must be `{params: {…}}`."
            raise RefusedError(422, "invalid_request", detail) from error
        text = await self._aside(lambda: _written(params))
        return JSONResponse({"yaml": text if params else ""})

    async def _aside(self, read: Callable[[], _T]) -> _T:
        """Call `read` in a thread: YAML is slow, and the event loop answers STOP.

        One call runs at a time, because more threads would share the interpreter, and
        so slow down the answer to a stop.
        """
        return await anyio.to_thread.run_sync(read, limiter=self._one_text)

    async def _teleoperate(self, socket: "WebSocket") -> None:
        session = self._find(socket)
        if session is None or session.role is not Role.OPERATOR:
            # A browser learns the code only of a socket that was opened.
            await socket.accept()
            code = _NOT_LOGGED_IN if session is None else _FORBIDDEN
            await socket.close(code, "operators only")
            return
        async with self._parts.access.client_of(session) as client:
            teleoperation = Teleoperation(
                client,
                self._parts.view,
                self._parts.movers,
                lambda: self._parts.access.renew(client, session),
            )
            moving = TeleoperationSocket(socket, teleoperation)
            # Its socket is open as long as the page is.
            keeping = asyncio.create_task(self._control.keep(session))
            try:
                await moving.run(lambda: self._sessions.wait_for_end(session))
            finally:
                keeping.cancel()
                await asyncio.wait([keeping])


def _written(params: dict[str, JsonValue]) -> str:
    return yaml.safe_dump(
        params, allow_unicode=True, default_flow_style=None, sort_keys=False
    )


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

    async def keep(self, session: "BrowserSession") -> None:
        """Send heartbeats while the session holds control; runs until cancelled.

        Call it while a page of the session is open.
        """
        while True:
            await asyncio.sleep(BEAT_PERIOD)
            await self.beat(session)

    async def beat(self, session: "BrowserSession") -> None:
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

    async def _show(self, session: "BrowserSession", _request: "Request") -> Response:
        return await self._answer(session, lambda client: client.lease.state())

    async def _take(self, session: "BrowserSession", wanted: _Taking) -> Response:
        owner, force = wanted.owner or None, wanted.force
        return await self._answer(
            session, lambda client: client.lease.take(owner, ttl=TTL, force=force)
        )

    async def _offer(self, session: "BrowserSession", wanted: _Offer) -> Response:
        to = wanted.hand_over_to
        return await self._answer(
            session, lambda client: client.lease.renew(hand_over_to=to)
        )

    async def _release(
        self, session: "BrowserSession", _request: "Request"
    ) -> Response:
        return await self._answer(session, lambda client: client.lease.release())

    async def _answer(
        self,
        session: "BrowserSession",
        ask: "Callable[[AsyncStationClient], Awaitable[ControlState]]",
    ) -> Response:
        state = await self._ask(session, ask)
        # No script of a page may have the lease: it would act beside the dashboard.
        return JSONResponse(state.model_dump(exclude={"lease"}))

    async def _ask(
        self,
        session: "BrowserSession",
        ask: "Callable[[AsyncStationClient], Awaitable[ControlState]]",
    ) -> "ControlState":
        key, asked_at = self._access.lease_of(session), self._now()
        state = await ask(self._access.acting_for(session))
        self._access.note(session, state, key, asked_at)
        return state
