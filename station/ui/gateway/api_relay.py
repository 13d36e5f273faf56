"""Forward requests and streams of the dashboard's pages to the station.

A page has the dashboard's cookie and no token. The relay adds the session's
credentials, so the station sees who acts, in which role and under which lease.
"""

import asyncio
import contextlib
import re
import ssl
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import TYPE_CHECKING, NoReturn

import httpx
from starlette.requests import ClientDisconnect
from starlette.responses import Response, StreamingResponse
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus, WebSocketException

from station.client.streams import certificates, close_connection
from station.ui.gateway.forwarded_routes import may_ask, may_forward, may_stream
from station.ui.link.socket_ends import close_socket, send_frame, until_first
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import BrowserSession, RefusedError
from station.wire.protocol import PREFIX, UPLOAD_PATH

if TYPE_CHECKING:
    from starlette.requests import Request

ANSWER_TIME = 70.0
"""Longest time for an answer of the station, e.g. while it loads a controller [s]."""
_CONNECT_TIME = 2.0
# The station closes a connection that was idle for 5 s. A request sent at that moment
# would be lost, on a busy machine sooner, so older connections are not used again.
_CONNECTIONS = httpx.Limits(
    max_connections=100, max_keepalive_connections=20, keepalive_expiry=2.0
)
_REQUEST_HEADERS = ("content-type", "if-match", "last-event-id", "accept")
_ANSWER_HEADERS = ("content-type", "etag", "content-disposition", "x-request-id")
# What ends a motion is right however late it comes; a stop is never refused as late.
_ENDS_MOTION = re.compile(r"/playback|/controllers/[^/]+/goals/[^/]+")
_UNSENT = (httpx.ConnectError, httpx.ConnectTimeout)
_MAX_FRAME_BYTES = 4 * 1024 * 1024
_STATION_GONE = 1012
_NOT_FOUND = 4404
_SESSION_ENDED = 4401


class ApiRelay:
    """Forwards the pages' own requests from the gateway to the station.

    Args:
        access: The credentials of the sessions.
        tls: How the station's certificate is checked; None for plain HTTP.
    """

    def __init__(
        self, access: SessionAccess, tls: ssl.SSLContext | None = None
    ) -> None:
        self._access = access
        self._tls = tls
        self._http = httpx.AsyncClient(
            trust_env=False,
            timeout=httpx.Timeout(ANSWER_TIME, connect=_CONNECT_TIME),
            limits=_CONNECTIONS,
            verify=certificates(tls),
        )

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def forward(self, request: "Request", session: BrowserSession) -> Response:
        """Return the station's answer to a page's request.

        Args:
            request: The request; its path begins with `PREFIX`.
            session: The browser's session.

        Returns:
            The station's answer.

        Raises:
            RefusedError: The route is not on the list (404), the session's role does
                not allow it (403), or the station does not answer (502).
        """
        # Checked although the station decides: the cookie must reach no route that no
        # dock needs.
        path = request.url.path.removeprefix(PREFIX)
        if not may_forward(request.method, path):
            detail = f"The dashboard does not forward {request.method} {path}."
            raise RefusedError(404, "not_forwarded", detail, "Use the station's API.")
        if not may_ask(session.role, request.method, path):
            raise RefusedError(
                403, "forbidden", "Viewers only watch.", "Log in as operator."
            )
        if self._access.is_lost:
            _refuse_unreachable("The station has ended, or is just being started anew")
        outgoing = self._http.build_request(
            request.method,
            f"{self._access.url}{PREFIX}{path}",
            params=httpx.QueryParams(request.url.query),
            # A file is passed on as it comes; all else is small, and sent as a whole.
            content=request.stream()
            if request.url.path == UPLOAD_PATH
            else await request.body(),
            headers=self._headers(request, session),
        )
        try:
            answer = await self._http.send(outgoing, stream=True)
        except ClientDisconnect:
            return Response(status_code=400)  # nobody reads it
        except httpx.TransportError as error:
            detail = f"The station does not answer ({type(error).__name__})"
            # A request that was sent may have been carried out without an answer.
            if request.method != "GET" and not isinstance(error, _UNSENT):
                detail += ". It is not known whether it was done"
            _refuse_unreachable(detail, error)
        # The station's clock, to which the deadlines of later requests refer.
        self._access.deadline.hear(answer.headers)
        headers = {
            name: answer.headers[name]
            for name in _ANSWER_HEADERS
            if name in answer.headers
        }
        return StreamingResponse(_body(answer), answer.status_code, headers)

    def _headers(self, request: "Request", session: BrowserSession) -> dict[str, str]:
        kept = {
            name: request.headers[name]
            for name in _REQUEST_HEADERS
            if name in request.headers
        }
        path = request.url.path.removeprefix(PREFIX)
        is_end = request.method == "DELETE" and _ENDS_MOTION.fullmatch(path)
        if request.method != "GET" and not is_end:
            kept |= self._access.deadline.headers()
        # The station is on this machine: compressing would cost both of them time.
        own = {"accept-encoding": "identity"}
        return {**kept, **own, **self._access.headers_of(session)}

    async def socket(
        self,
        browser: WebSocket,
        session: BrowserSession,
        wait_for_end: Callable[[], Awaitable[None]],
    ) -> None:
        """Pass a stream's frames to a browser until either closes or the session ends.

        While no station runs, the socket waits, so that the page gets frames again as
        soon as the station is back, without a new request.

        Args:
            browser: The browser's WebSocket, not accepted yet.
            session: The browser's session.
            wait_for_end: Returns when that session has ended.
        """
        topic = str(browser.path_params["topic"])
        # A browser learns why a socket closes only of a socket that was opened.
        with contextlib.suppress(WebSocketDisconnect):  # It may have gone already.
            await browser.accept()
        if not may_stream(topic):
            await close_socket(
                browser, _NOT_FOUND, "the dashboard does not forward this"
            )
            return
        if not await self._wait_for_station(browser, wait_for_end):
            return
        address = self._access.url.replace("http", "ws", 1)
        query = f"?{browser.url.query}" if browser.url.query else ""
        try:
            upstream = await connect(
                f"{address}{PREFIX}/streams/{topic}{query}",
                additional_headers=self._access.headers_of(session),
                compression=None,
                max_size=_MAX_FRAME_BYTES,
                max_queue=4,
                proxy=None,
                ssl=self._tls,
                open_timeout=_CONNECT_TIME,
                close_timeout=0.5,
            )
        except InvalidStatus:
            await close_socket(browser, _NOT_FOUND, "the station has no such stream")
            return
        except (OSError, WebSocketException):
            await close_socket(browser, _STATION_GONE, "the station does not answer")
            return
        try:
            await _pass_frames(browser, upstream, wait_for_end)
        finally:
            await close_connection(upstream)

    async def _wait_for_station(
        self, browser: WebSocket, wait_for_end: Callable[[], Awaitable[None]]
    ) -> bool:
        """Wait for a station; return False when the browser or its session is gone."""
        if not self._access.is_lost:
            return True
        ended = asyncio.ensure_future(wait_for_end())
        back = asyncio.create_task(self._access.wait_for_station())
        await until_first(ended, back, asyncio.create_task(_until_gone(browser)))
        if not ended.cancelled():
            await close_socket(browser, _SESSION_ENDED, "the session has ended")
        return not back.cancelled() and ended.cancelled()


async def _pass_frames(
    browser: WebSocket,
    upstream: ClientConnection,
    wait_for_end: Callable[[], Awaitable[None]],
) -> None:
    ended = asyncio.ensure_future(wait_for_end())
    downwards = asyncio.create_task(_to_browser(browser, upstream))
    listening = asyncio.create_task(_until_gone(browser))
    await until_first(ended, downwards, listening)
    is_over = not ended.cancelled()
    if listening.done() and not listening.cancelled():
        return
    code = _SESSION_ENDED if is_over else upstream.close_code or _STATION_GONE
    await close_socket(
        browser, code if code >= 3000 else _STATION_GONE, "the stream has ended"
    )


async def _to_browser(browser: WebSocket, upstream: ClientConnection) -> None:
    with contextlib.suppress(ConnectionClosed):  # The caller closes the other end.
        async for frame in upstream:
            if not await send_frame(browser, frame):
                return


async def _until_gone(browser: WebSocket) -> None:
    """Wait until the browser has closed; its messages are dropped."""
    while (await browser.receive())["type"] != "websocket.disconnect":
        pass


async def _body(answer: httpx.Response) -> AsyncIterator[bytes]:
    try:
        async for part in answer.aiter_bytes():
            yield part
    finally:
        await answer.aclose()


def _refuse_unreachable(detail: str, cause: Exception | None = None) -> NoReturn:
    remedy = "Look whether `station run` still runs; this page reconnects."
    raise RefusedError(502, "unreachable", f"{detail}.", remedy) from cause
