"""Pass a browser's requests on to Viser, and its frames both ways."""

import asyncio
import contextlib
from collections.abc import Awaitable, Callable

import httpx
import msgspec
from starlette.responses import PlainTextResponse, Response
from starlette.websockets import WebSocket
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from station.ui.gateway.viser_server import SECRET_HEADER, SESSION_HEADER
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


class ViserRelay:
    """The gateway's connection to Viser.

    Args:
        port: Loopback port Viser listens on.
        secret: The secret that Viser asks for.
    """

    def __init__(self, port: int, secret: str) -> None:
        self._address = f"127.0.0.1:{port}"
        self._headers = {SECRET_HEADER: secret}
        self._http = httpx.AsyncClient(trust_env=False, timeout=5.0)
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
        async with upstream:
            await browser.accept(subprotocol=upstream.subprotocol)
            ended = asyncio.ensure_future(wait_for_end())
            await _relay(browser, upstream, role, ended)


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
