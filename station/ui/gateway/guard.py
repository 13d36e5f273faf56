"""Checks before every request, and security headers of every answer."""

from collections.abc import Collection
from typing import TYPE_CHECKING

from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketClose

from station.web.host_policy import HostPolicy
from station.web.limited_server import announces_more_than, limited
from station.wire.protocol import PREFIX, largest_body

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send


MAX_BODY_BYTES = 4096
"""Largest body of the gateway's own requests: the login form has one field."""
_LARGE_BODIES = (f"{PREFIX}/", "/workspace/")
_SAFE_METHODS = frozenset({"GET", "HEAD"})
_TOO_MUCH = HTTPException(413, headers={"connection": "close"})
_PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; form-action 'self'; base-uri 'none'; "
    "frame-ancestors 'none'"
)
# Viser's page is one file with its scripts, workers and WebAssembly inside.
_VISER_POLICY = (
    "default-src 'none'; "
    "script-src 'self' 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval' blob: data:; "
    "worker-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; "
    "connect-src 'self' data: blob:; "
    "form-action 'none'; base-uri 'none'; frame-ancestors 'self'"
)
LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})


def session_cookie(scope: "Scope") -> str:
    """Return the cookie's name with the port, because a host's ports share cookies."""
    server = scope.get("server")
    return f"station_dashboard_{server[1] if server else 0}"


def origin_policy(host: str, extra_names: Collection[str] = ()) -> HostPolicy:
    """Return the hosts and pages that the dashboard answers.

    A literal IP address cannot be rebound by a DNS server, so it is allowed when the
    server listens beyond loopback. Browsers send an Origin with every changing request.

    Args:
        host: Address the server is bound to.
        extra_names: Further host names under which users reach the server.
    """
    return HostPolicy(
        {*LOOPBACK_NAMES, host, *extra_names},
        any_address=host not in LOOPBACK_NAMES,
        programs=False,
    )


class GatewayGuard:
    """ASGI middleware that refuses foreign hosts and pages, and adds security headers.

    Args:
        app: The application that it guards.
        origins: Decides which Host and Origin headers are answered.
    """

    def __init__(self, app: "ASGIApp", origins: HostPolicy) -> None:
        self._app = app
        self._origins = origins

    async def __call__(self, scope: "Scope", receive: "Receive", send: "Send") -> None:
        """Answer a request or pass it on."""
        if scope["type"] not in {"http", "websocket"}:
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        limit = _largest_body(scope)
        # A foreign page is refused first: it learns nothing of the limits.
        if not refusal and announces_more_than(scope, limit):
            await _too_large(limit)(scope, receive, send)
        elif refusal and scope["type"] == "websocket":
            await WebSocketClose(4403, refusal)(scope, receive, send)
        elif refusal:
            await PlainTextResponse(refusal + "\n", 403)(scope, receive, send)
        else:
            await self._pass_on(scope, receive, _sealing(scope, send))

    async def _pass_on(self, scope: "Scope", receive: "Receive", send: "Send") -> None:
        if scope["type"] == "http":
            receive = limited(receive, _largest_body(scope), _TOO_MUCH)
        await self._app(scope, receive, send)

    def _refusal(self, scope: "Scope") -> str:
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if not self._origins.allows_host(host):
            return f"This dashboard does not answer to the host {host!r}."
        origin = headers.get("origin")
        changes = scope["type"] == "websocket" or scope["method"] not in _SAFE_METHODS
        # Browsers name no Origin when a page reads from its own server.
        is_asked = changes or origin is not None
        if is_asked and not self._origins.allows_origin(origin, host):
            return "Only the dashboard's own pages may do this."
        return ""


def _largest_body(scope: "Scope") -> int:
    large = scope["path"].startswith(_LARGE_BODIES)
    return largest_body(scope["path"]) if large else MAX_BODY_BYTES


def _too_large(limit: int) -> PlainTextResponse:
    text = f"The body is larger than the {limit} bytes allowed.\n"
    return PlainTextResponse(text, 413, {"connection": "close"})


def _sealing(scope: "Scope", send: "Send") -> "Send":
    viser = scope["path"].startswith("/ui")

    async def sealed(message: "Message") -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers.setdefault("Cache-Control", "no-store")
            headers["Content-Security-Policy"] = (
                _VISER_POLICY if viser else _PAGE_POLICY
            )
            headers["X-Content-Type-Options"] = "nosniff"
            # Not `no-referrer`: browsers then send `Origin: null` with the login form.
            headers["Referrer-Policy"] = "same-origin"
            headers["Cross-Origin-Opener-Policy"] = "same-origin"
            headers["Cross-Origin-Resource-Policy"] = "same-origin"
        await send(message)

    return sealed
