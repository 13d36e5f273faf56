"""Requests of the page that the gateway answers itself: docks, examples, the desk."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TypeVar

import anyio
import anyio.to_thread
import yaml
from pydantic import BaseModel, JsonValue, ValidationError
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute

from station.core.config_error import ConfigError
from station.core.yaml_reader import FORM, parse_yaml
from station.ui.link.station_view import StationView
from station.ui.page.control_routes import ControlRoutes, refused
from station.ui.page.load_examples import example_parameters, suggested_name
from station.ui.page.page_state import workspace_state
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import Role, Session, Sessions
from station.ui.teleoperation.joint_teleoperation import Movers
from station.ui.teleoperation.teleoperation import Teleoperation
from station.ui.teleoperation.teleoperation_socket import TeleoperationSocket

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute
    from starlette.websockets import WebSocket

_T = TypeVar("_T")
_NOT_LOGGED_IN = 4401
_FORBIDDEN = 4403


class _Parameters(BaseModel):
    """Parameters of a controller, as the fields of the page have them."""

    params: dict[str, JsonValue]


class FindSession(Protocol):
    """Finds the session of a connection."""

    def __call__(self, connection: "Request | WebSocket") -> Session | None:
        """Return the session of a connection, or None."""
        ...


@dataclass(frozen=True, slots=True)
class WorkspaceParts:
    """What the workspace is made of.

    Attributes:
        view: Returns what is known of the station; callable by any thread.
        access: The credentials of the sessions at the station.
        triangles: How many triangles the drawn robots have.
        not_drawn: Why no robot is drawn; empty when there is no such reason.
        movers: Who moves which joint, shared by all that command joints.
    """

    view: Callable[[], StationView]
    access: SessionAccess
    triangles: int = 0
    not_drawn: str = ""
    movers: Movers = field(default_factory=Movers)


class WorkspaceRoutes:
    """The routes below `/workspace`.

    Args:
        parts: What they are made of.
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
        self._one_text = anyio.CapacityLimiter(1)

    def routes(self) -> "list[BaseRoute]":
        """Return the routes."""
        return [
            Route("/workspace/state", self._state),
            Route("/workspace/example", self._example),
            Route("/workspace/parameters", self._read_yaml, methods=["POST"]),
            Route("/workspace/yaml", self._write_yaml, methods=["POST"]),
            WebSocketRoute("/workspace/desk", self._desk),
            *self._control.routes(),
        ]

    async def _state(self, request: "Request") -> Response:
        if self._find(request) is None:
            return _no_session()
        drawing = {
            "triangles": self._parts.triangles,
            "not_drawn": self._parts.not_drawn,
        }
        return JSONResponse({**workspace_state(self._parts.view()), **drawing})

    async def _example(self, request: "Request") -> Response:
        """Answer a free name, and parameters with which a type loads on this robot."""
        if self._find(request) is None:
            return _no_session()
        kind = request.query_params.get("type", "")
        view = self._parts.view()
        arm = request.query_params.get("arm", "")
        text = example_parameters(kind, view.positions, arm)
        return JSONResponse({
            "name": suggested_name(kind, (c.name for c in view.controllers)),
            "yaml": text,
            "params": parse_yaml(text, "Example", FORM).values,
        })

    async def _read_yaml(self, request: "Request") -> Response:
        """Answer the parameters that a text in YAML means, or where it is wrong."""
        refusal = self._refusal(request)
        if refusal is not None:
            return refusal
        text = (await request.body()).decode("utf-8", errors="replace")
        try:
            read = await self._aside(lambda: parse_yaml(text, "Parameters", FORM))
        except ConfigError as error:
            return refused(422, "invalid_yaml", error.message, error.remedy)
        try:
            return JSONResponse({"params": read.values})
        except ValueError:
            detail = "A number is infinite or none; JSON has finite numbers alone."
            return refused(422, "invalid_yaml", detail)

    async def _write_yaml(self, request: "Request") -> Response:
        """Answer parameters, the JSON under `params`, as a text in YAML."""
        refusal = self._refusal(request)
        if refusal is not None:
            return refusal
        body = await request.body()
        if len(body) > FORM.characters:
            detail = f"The parameters have more than {FORM.characters} characters."
            return refused(413, "body_too_large", detail, "Shorten them.")
        try:
            params = _Parameters.model_validate_json(body).params
        except ValidationError:
            return refused(422, "invalid_request", "The body must be `{params: {…}}`.")
        text = await self._aside(lambda: _written(params))
        return JSONResponse({"yaml": text if params else ""})

    def _refusal(self, request: "Request") -> Response | None:
        """Return the refusal of who is no operator; only operators load controllers."""
        session = self._find(request)
        if session is None:
            return _no_session()
        if session.role is not Role.OPERATOR:
            return refused(403, "forbidden", "Viewers only watch.")
        return None

    async def _aside(self, read: Callable[[], _T]) -> _T:
        """Call `read` beside the event loop, which answers STOP: YAML is slow.

        One at a time: more threads would share the same interpreter, and so slow down
        the answer to a stop.
        """
        return await anyio.to_thread.run_sync(read, limiter=self._one_text)

    async def _desk(self, socket: "WebSocket") -> None:
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


def _no_session() -> Response:
    return refused(401, "no_session", "Log in first.")
