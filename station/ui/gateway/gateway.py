"""The only way into the dashboard: login, checks, the page's frame, the stop button.

```
browser ── cookie, Host, Origin ──▶ gateway ── secret header ──▶ Viser (loopback)
                                       └── stop, login ── station.client ──▶ station
```

Viser has no login, and its page may lose a click. So this gateway stands before it:
nothing is shown or done without a session, and the stop button is the gateway's own.
"""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import asdict, dataclass, field
from hashlib import blake2b
from importlib import resources
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Protocol
from urllib.parse import parse_qs, urlencode

import httpx
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.routing import Route, WebSocketRoute

from station.client import ApiError, AsyncStationClient, StationUnreachableError
from station.client.streams import certificates
from station.ui.gateway.guard import GatewayGuard, session_cookie
from station.ui.page.view_routes import ShownViews, ViewRoutes
from station.ui.page.workspace_routes import WorkspaceParts, WorkspaceRoutes
from station.ui.sessions.sessions import (
    BrowserSession,
    RefusedError,
    Role,
    SessionRoutes,
    Sessions,
)
from station.web.failed_logins import FailedLogins
from station.web.host_policy import HostPolicy
from station.wire import StopState
from station.wire.protocol import PREFIX

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable

    from starlette.requests import Request
    from starlette.websockets import WebSocket

    from station.ui.gateway.api_relay import ApiRelay
    from station.ui.gateway.viser_relay import ViserRelay
    from station.ui.page.page_state import BarState

_STATIC_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
}
_STOP = f"{PREFIX}/stop"
_METHODS = ["GET", "POST", "PUT", "PATCH", "DELETE"]
_VIEW_PARAMETERS = frozenset({"darkMode", "initialCameraPosition"})
ANSWER_TIME = 0.5
"""Longest time for an answer of the station before the watchdog is asked [s]."""
_WATCHDOG_TIME = 2.0
_REASON = "stop button of the dashboard"


class Release(Protocol):
    """Releases a stop."""

    def __call__(self, session: BrowserSession, *, arm: bool) -> "Awaitable[StopState]":
        """Release a stop for a session; with `arm`, allow motion, the second step."""
        ...


@dataclass(frozen=True, slots=True)
class GatewayParts:
    """The parts of the dashboard that the gateway connects.

    Attributes:
        role_of: Asks the station which role a token has; None for a wrong token.
            Raises `ApiError` when the station does not answer.
        stop: Stops the robot. Raises `ApiError` when the stop is not confirmed.
        release: Releases a stop for a session; with True, takes the second step, which
            allows motion again.
        bar: Returns the present content of the status strip.
        relay: Forwards requests to Viser.
        api: Forwards the pages' own requests to the station.
        workspace: The parts that the docks of the page need.
        views: The views of all sessions.
        origins: Decides which Host and Origin headers are answered.
        sessions: The logged-in browsers.
        failed_logins: The addresses that have sent wrong tokens.
    """

    role_of: Callable[[str], Awaitable[Role | None]]
    stop: Callable[[], Awaitable["StopState"]]
    release: Release
    bar: Callable[[], "BarState"]
    relay: "ViserRelay"
    api: "ApiRelay"
    workspace: WorkspaceParts
    views: ShownViews
    origins: HostPolicy
    sessions: Sessions
    failed_logins: FailedLogins = field(default_factory=FailedLogins)


def build_gateway(parts: GatewayParts) -> Starlette:
    """Return the gateway as an ASGI application."""
    gateway = _Gateway(parts)
    workspace = WorkspaceRoutes(parts.workspace, parts.sessions, gateway.find_session)
    views = ViewRoutes(parts.views, gateway.find_session)
    make = SessionRoutes(gateway.find_session)
    return Starlette(
        routes=[
            Route("/", gateway.page),
            Route("/login", gateway.login_page),
            Route("/login", gateway.login, methods=["POST"]),
            Route("/logout", gateway.logout, methods=["POST"]),
            make.route("GET", "/session", gateway.session),
            make.route("GET", "/state", gateway.state),
            make.route("POST", "/stop", gateway.stop),
            make.route("POST", "/release", gateway.release, operators_only=True),
            make.route("POST", "/arm", gateway.arm, operators_only=True),
            Route("/static/{name:path}", _static),
            *workspace.routes(),
            *views.routes(),
            WebSocketRoute(PREFIX + "/streams/{topic:path}", gateway.stream),
            *(make.route(m, PREFIX + "/{path:path}", gateway.api) for m in _METHODS),
            Route("/ui/", gateway.viser_page),
            WebSocketRoute("/ui", gateway.viser_socket),
            WebSocketRoute("/ui/", gateway.viser_socket),
        ],
        middleware=[Middleware(GatewayGuard, origins=parts.origins)],
    )


class _Gateway:
    def __init__(self, parts: GatewayParts) -> None:
        self._parts = parts

    def find_session(self, connection: "Request | WebSocket") -> BrowserSession | None:
        """Return the session of a connection, or None."""
        cookie = connection.cookies.get(session_cookie(connection.scope))
        return self._parts.sessions.find(cookie)

    async def page(self, request: "Request") -> Response:
        if self.find_session(request) is None:
            return RedirectResponse("/login", 303)
        return _file("page.html", "text/html; charset=utf-8")

    async def login_page(self, request: "Request") -> Response:
        token = request.query_params.get("token")
        if token is not None:
            return await self._log_in(request, token)
        if self.find_session(request) is not None:
            return RedirectResponse("/", 303)
        return _file("login.html", "text/html; charset=utf-8")

    async def login(self, request: "Request") -> Response:
        body = await request.body()
        fields = parse_qs(body.decode("utf-8", errors="replace"))
        return await self._log_in(request, fields.get("token", [""])[0])

    async def _log_in(self, request: "Request", token: str) -> Response:
        try:
            role = await self._parts.role_of(token.strip()) if token.strip() else None
        except ApiError:
            return RedirectResponse("/login?" + urlencode({"refused": "link"}), 303)
        # A wrong token is answered late, so that tokens cannot be guessed quickly.
        if role is None:
            await self._parts.failed_logins.slow_down(request)
            return RedirectResponse("/login?" + urlencode({"refused": "token"}), 303)
        kept = self._parts.workspace.access.own_token(token.strip())
        session = self._parts.sessions.open(role, kept)
        # The redirect takes the token out of the address and of the history.
        answer = RedirectResponse("/", 303)
        answer.set_cookie(
            session_cookie(request.scope),
            session.identifier,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
        return answer

    async def logout(self, request: "Request") -> Response:
        name = session_cookie(request.scope)
        self._parts.sessions.close(request.cookies.get(name))
        answer = RedirectResponse("/login", 303)
        answer.delete_cookie(name, httponly=True, samesite="strict")
        return answer

    async def session(self, session: BrowserSession, _request: "Request") -> Response:
        return JSONResponse({"role": session.role.value})

    async def state(self, session: BrowserSession, _request: "Request") -> Response:
        return JSONResponse({**asdict(self._parts.bar()), "role": session.role.value})

    async def stop(self, _session: BrowserSession, _request: "Request") -> Response:
        return _stop_answer(await self._parts.stop())

    async def release(self, session: BrowserSession, _request: "Request") -> Response:
        self._refuse_if_lost()
        return _stop_answer(await self._parts.release(session, arm=False))

    async def arm(self, session: BrowserSession, _request: "Request") -> Response:
        self._refuse_if_lost()
        return _stop_answer(await self._parts.release(session, arm=True))

    async def api(self, session: BrowserSession, request: "Request") -> Response:
        # A stop is always tried: the station may answer although its streams do not.
        if request.url.path != _STOP:
            self._refuse_if_lost()
        access = self._parts.workspace.access
        token = access.token_of(session)
        answer = await self._parts.api.forward(request, session)
        # The token was withdrawn; a session without it could only fail.
        if answer.status_code == 401 and access.is_withdrawn(session, token):
            self._parts.sessions.close(session.identifier)
        return answer

    def _refuse_if_lost(self) -> None:
        """Refuse a request while the station is lost.

        Raises:
            RefusedError: The station is lost.
        """
        # A browser has six connections, and one of them must be left for the stop. A
        # request that waited would be carried out when nobody expects it any more.
        if self._parts.bar().link == "lost":
            raise RefusedError(
                502,
                "unreachable",
                "The station does not answer.",
                "STOP works. Look whether `station run` still runs.",
            )

    async def stream(self, socket: "WebSocket") -> None:
        session = self.find_session(socket)
        if session is None:
            await socket.accept()  # A browser learns the code of an open socket only.
            await socket.close(4401, "log in first")
            return
        sessions = self._parts.sessions
        await self._parts.api.socket(
            socket, session, lambda: sessions.wait_for_end(session)
        )

    async def viser_page(self, request: "Request") -> Response:
        if self.find_session(request) is None:
            return RedirectResponse("/login", 303)
        if not set(request.query_params) <= _VIEW_PARAMETERS:
            # `?websocket=` and `?playbackPath=` make Viser's page load from elsewhere.
            return RedirectResponse("/ui/", 303)
        return await self._parts.relay.page()

    async def viser_socket(self, socket: "WebSocket") -> None:
        session = self.find_session(socket)
        if session is None:
            await socket.close(4401, "log in first")
            return
        sessions = self._parts.sessions
        access = self._parts.workspace.access
        await self._parts.relay.socket(
            socket,
            session.key,
            lambda: access.role_at_viser(session),
            lambda: sessions.wait_for_end(session),
        )


def _stop_answer(state: "StopState") -> Response:
    return JSONResponse({"state": state.state, "epoch": state.epoch})


async def _static(request: "Request") -> Response:
    name = request.path_params["name"]
    if name not in _STATIC_FILES:  # one may have come since the start
        _STATIC_FILES.update(_static_files(_STATIC))
    if name not in _STATIC_FILES:
        return Response(status_code=404)
    answer = _file(name, _STATIC_TYPES[PurePosixPath(name).suffix])
    # Of the content, because an upgrade in place may keep the times and sizes of files.
    tag = f'"{blake2b(answer.body, digest_size=16).hexdigest()}"'
    kept = {"Cache-Control": "no-cache", "ETag": tag}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=kept)
    answer.headers.update(kept)
    return answer


def _static_files(folder: "Traversable", prefix: str = "") -> Iterator[str]:
    """Yield the names of the scripts and styles that pages load."""
    for file in folder.iterdir():
        if file.is_dir():
            yield from _static_files(file, f"{prefix}{file.name}/")
        elif PurePosixPath(file.name).suffix in _STATIC_TYPES:
            yield prefix + file.name


_STATIC = resources.files("station.ui").joinpath("static")
_STATIC_FILES = set(_static_files(_STATIC))


def _file(name: str, media_type: str) -> Response:
    return Response(_STATIC.joinpath(name).read_bytes(), media_type=media_type)


class StopButton:
    """Stops the robot, even if the station's interpreter hangs.

    Args:
        api: The station.
        token: Its token, which the watchdog accepts as well.
        watchdog_url: The listener of the station's watchdog; empty when there is none.
    """

    def __init__(self, api: AsyncStationClient, token: str, watchdog_url: str) -> None:
        self._api = api
        self._token = token
        self._watchdog_url = watchdog_url

    def move_to(self, token: str, watchdog_url: str) -> None:
        """Ask the watchdog of another station from now on."""
        self._token, self._watchdog_url = token, watchdog_url

    async def press(self) -> StopState:
        """Stop the robot.

        Raises:
            ApiError: Neither the station nor its watchdog confirms the stop.
        """
        if not self._watchdog_url:
            return await self._api.stop(_REASON)
        try:
            async with asyncio.timeout(ANSWER_TIME):
                state = await self._api.stop(_REASON)
        except (TimeoutError, StationUnreachableError) as error:
            return await self._ask_watchdog(error)
        if not state.pending:
            return state
        # The station answers, and its control loop does not: the watchdog tells a real
        # arm to hold.
        return await self._ask_watchdog(LookupError("the control loop does not answer"))

    async def _ask_watchdog(self, cause: Exception) -> StopState:
        """Latch the stop through the watchdog.

        Raises:
            StationUnreachableError: The watchdog does not answer either.
        """
        headers = {"Authorization": f"Bearer {self._token}"}
        try:
            verify = certificates(None)
            async with httpx.AsyncClient(trust_env=False, verify=verify) as http:
                answer = await http.post(
                    f"{self._watchdog_url}/stop",
                    json={"reason": _REASON},
                    headers=headers,
                    timeout=_WATCHDOG_TIME,
                )
                answer.raise_for_status()
                report = answer.json()
        except httpx.HTTPError as error:
            raise StationUnreachableError(self._api.url, cause) from error
        return StopState(
            state="stopped",
            reason=report["detail"],
            epoch=0,  # only the station knows it
            pending=not report["carried_out"],
        )
