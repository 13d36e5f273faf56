"""Start Viser so that only the gateway can talk to it, and relay browsers' requests.

Viser has no login. It listens on a loopback port and refuses connections without the
gateway's secret, because other users of the same machine reach loopback too. The check
hooks into the `serve` that Viser calls, which is private. So `viser` is pinned, and
`tests/ui/gateway/test_viser_server.py` fails when the hook no longer works.
"""

import asyncio
import contextlib
import hmac
import io
import secrets
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

import httpx
import msgspec
import viser
import websockets.asyncio.server
from starlette.responses import PlainTextResponse, Response
from starlette.websockets import WebSocket
from viser import _messages as viser_messages  # noqa: PLC2701 - no public name
from websockets import http11
from websockets.asyncio.client import ClientConnection, connect
from websockets.asyncio.server import (
    ServerConnection,
    serve as Serve,  # noqa: N812 - it is a class
)
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from station.client.streams import certificates, close_connection
from station.ui.link.socket_ends import close_socket, send_frame, until_first
from station.ui.sessions.sessions import Role

_MAX_FRAME_BYTES = 64 * 1024 * 1024
_NO_UPSTREAM = 1013
_SESSION_ENDED = 4401
# Codes that an endpoint may not send: 1005, 1006 and 1015 only report.
_UNSENDABLE = frozenset({1005, 1006, 1015})
_CAMERA = "ViewerCameraMessage"
_WIDGET_VALUE = "GuiUpdateMessage"
_VIEWER_MESSAGES = frozenset({_CAMERA})
_OPERATOR_MESSAGES = frozenset({
    _CAMERA,
    _WIDGET_VALUE,
    "GuiButtonHoldMessage",
    "TransformControlsUpdateMessage",
    "TransformControlsDragStartMessage",
    "TransformControlsDragEndMessage",
    "SceneNodeDragMessage",
})
SECRET_HEADER = "X-Station-Gateway"
SESSION_HEADER = "X-Station-Session"
"""Carries the key of the session whose browser opens a connection."""

_ProcessRequest = Callable[[ServerConnection, http11.Request], http11.Response | None]


class ViserRelay:
    """The gateway's connection to Viser.

    Args:
        port: Loopback port Viser listens on.
        secret: The secret that Viser asks for.
    """

    def __init__(self, port: int, secret: str) -> None:
        self._address = f"127.0.0.1:{port}"
        self._headers = {SECRET_HEADER: secret}
        self._http = httpx.AsyncClient(
            trust_env=False, timeout=5.0, verify=certificates(None)
        )
        # Kept, since it is one file of 0.8 MB that never changes.
        self._page: bytes | None = None

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def page(self) -> Response:
        """Return Viser's page; it is one file and never changes."""
        if self._page is None:
            try:
                answer = await self._http.get(
                    f"http://{self._address}/", headers=self._headers
                )
            except httpx.TransportError:
                return PlainTextResponse("The 3D view is not running.\n", 502)
            if not answer.is_success:
                return PlainTextResponse("The 3D view refused to open.\n", 502)
            self._page = answer.content
        return Response(self._page, media_type="text/html; charset=utf-8")

    async def socket(
        self,
        browser: WebSocket,
        key: str,
        role: Callable[[], Role],
        wait_for_end: Callable[[], Awaitable[None]],
    ) -> None:
        """Connect a browser with Viser until either closes or the session ends.

        Args:
            browser: The browser's WebSocket, not accepted yet.
            key: Key of the browser's session.
            role: Returns the role that decides which of its frames pass.
            wait_for_end: Returns when the browser's session has ended.
        """
        offered = [Subprotocol(name) for name in browser.scope["subprotocols"]]
        try:
            upstream = await connect(
                f"ws://{self._address}/",
                additional_headers={**self._headers, SESSION_HEADER: key},
                subprotocols=offered or None,
                compression=None,
                # The first message has all meshes of the robots: 2 MB for a Panda.
                max_size=_MAX_FRAME_BYTES,
                proxy=None,
                ping_interval=None,
                close_timeout=0.5,
            )
        except (OSError, WebSocketException):
            await browser.close(_NO_UPSTREAM, "the 3D view is not running")
            return
        try:
            await browser.accept(subprotocol=upstream.subprotocol)
            ended = asyncio.ensure_future(wait_for_end())
            await _relay(browser, upstream, role, ended)
        finally:
            await close_connection(upstream)


async def _relay(
    browser: WebSocket,
    upstream: ClientConnection,
    role: Callable[[], Role],
    ended: asyncio.Future[None],
) -> None:
    downwards = asyncio.create_task(_to_browser(browser, upstream))
    upwards = asyncio.create_task(_to_viser(browser, upstream, role))
    await until_first(downwards, upwards, ended)
    if not ended.cancelled():
        await close_socket(browser, _SESSION_ENDED, "the session has ended")


async def _to_browser(browser: WebSocket, upstream: ClientConnection) -> None:
    """Send Viser's frames on; forward its close code at the end."""
    with contextlib.suppress(ConnectionClosed):  # The code below tells the browser.
        async for frame in upstream:
            if not await send_frame(browser, frame):
                return
    await close_socket(browser, *_closing(upstream.close_code, upstream.close_reason))


async def _to_viser(
    browser: WebSocket, upstream: ClientConnection, role: Callable[[], Role]
) -> None:
    """Send the browser's frames on, those that may pass; forward its close code."""
    while True:
        message = await browser.receive()
        if message["type"] == "websocket.disconnect":
            await upstream.close(*_closing(message.get("code"), message.get("reason")))
            return
        frame = message.get("bytes")
        if frame is not None and may_pass(frame, role()):
            try:
                await upstream.send(frame)
            except ConnectionClosed:
                return


def _closing(code: int | None, reason: str | None) -> tuple[int, str]:
    if code is None or code in _UNSENDABLE:
        return 1001, ""
    return code, reason or ""


def may_pass(frame: bytes, role: Role) -> bool:
    """Return whether a frame from a browser with this role may reach Viser.

    Args:
        frame: One binary WebSocket message, msgpack as Viser's page sends it.
        role: Role of the browser's session.

    Returns:
        True for the camera's pose from everybody, and for widget values, held
        buttons and dragged frames from an operator; False for everything else,
        malformed frames included.
    """
    try:
        message = msgspec.msgpack.decode(frame)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return False
    if not isinstance(message, dict):
        return False
    kind = message.get("type")
    allowed = _OPERATOR_MESSAGES if role is Role.OPERATOR else _VIEWER_MESSAGES
    if kind not in allowed:
        return False
    # Any other attribute would change the panel itself, e.g. the ends of a slider.
    if kind == _WIDGET_VALUE:
        updates = message.get("updates")
        return isinstance(updates, dict) and set(updates) == {"value"}
    return True


@dataclass(frozen=True, slots=True)
class GuardedViser:
    """A Viser server that only the gateway can reach.

    Attributes:
        server: The Viser server, listening on 127.0.0.1.
        port: The port it listens on.
        secret: The value of `SECRET_HEADER` that opens it.
    """

    server: viser.ViserServer
    port: int
    secret: str

    def session_key(self, client: viser.ClientHandle) -> str:
        """Return the key of the session of a browser; empty when it is unknown."""
        # Viser tells no request headers, but it keeps the connections that have them.
        live = self.server._websock_server._live_connections  # noqa: SLF001
        connection = live.get(client.client_id)
        if connection is None or connection.request is None:
            return ""
        return connection.request.headers.get(SESSION_HEADER, "")

    def stop(self) -> None:
        """Stop the server and its threads."""
        with _quiet():
            self.server.stop()


def open_viser(label: str) -> GuardedViser:
    """Start a Viser server on a free loopback port that asks for a secret.

    Args:
        label: Title of its control panel.

    Returns:
        The running server and the secret that opens it.
    """
    secret = secrets.token_urlsafe(32)
    with _quiet(), _secret_before_serve(secret):
        server = viser.ViserServer(host="127.0.0.1", port=0, label=label, verbose=False)
    connection = server._websock_server  # noqa: SLF001 - Viser has no public way
    connection.unregister_handler(viser_messages.ShareUrlRequest)
    connection.unregister_handler(viser_messages.ShareUrlDisconnect)
    return GuardedViser(server, server.get_port(), secret)


@contextlib.contextmanager
def _secret_before_serve(secret: str) -> Iterator[None]:
    """Let every WebSocket server that starts inside this block ask for the secret."""
    serve = Serve
    expected = secret.encode()

    def guarded_serve(
        *args: Any,  # noqa: ANN401 - whatever Viser passes
        process_request: _ProcessRequest | None = None,
        **kwargs: Any,  # noqa: ANN401 - whatever Viser passes
    ) -> Serve:
        return serve(
            *args, process_request=_secret_check(expected, process_request), **kwargs
        )

    websockets.asyncio.server.serve = guarded_serve  # type: ignore[misc, assignment]  # the hook
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve  # type: ignore[misc]  # as it was


def _secret_check(
    expected: bytes,
    inner: _ProcessRequest | None,
) -> _ProcessRequest:
    def process_request(
        connection: ServerConnection, request: http11.Request
    ) -> http11.Response | None:
        brought = request.headers.get_all(SECRET_HEADER)
        value = brought[0].encode() if len(brought) == 1 else b""
        if not hmac.compare_digest(value, expected):
            return connection.respond(
                HTTPStatus.FORBIDDEN, "Open the dashboard at its own address.\n"
            )
        return None if inner is None else inner(connection, request)

    return process_request


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep Viser from printing an address that must not be opened."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
