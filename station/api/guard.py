"""The first check of every request: Host, Origin, and the size of the body."""

import time

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from station.api.errors import ProblemError
from station.web.host_policy import HostPolicy
from station.web.limited_server import announces_more_than, limited
from station.wire import CLOSE_FORBIDDEN
from station.wire.protocol import (
    CLOCK_HEADER,
    MAX_BODY_BYTES,
    MAX_UPLOAD_BYTES,
    PREFIX,
    UPLOAD_PATH,
)

_PROBES = frozenset({f"{PREFIX}/health", f"{PREFIX}/ready"})
_CLOCK = CLOCK_HEADER.lower().encode()
_HEADERS = (
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cache-control", b"no-store"),
)


class Guard:
    """Refuses requests from other origins and large bodies, before they are read.

    Args:
        app: The application that gets all other requests.
        policy: Decides on Host and Origin headers.
        max_body: Largest request body [bytes], except for an uploaded file.
    """

    def __init__(
        self, app: ASGIApp, policy: HostPolicy, max_body: int = MAX_BODY_BYTES
    ) -> None:
        self._app = app
        self._policy = policy
        self._max_body = max_body

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a refused request; pass every other request on."""
        if scope["type"] == "websocket":
            await self._websocket(scope, receive, send)
        elif scope["type"] == "http":
            await self._http(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    async def _websocket(self, scope: Scope, receive: Receive, send: Send) -> None:
        refused = self._place_refused(scope)
        if refused is None:
            await self._app(scope, receive, send)
            return
        # A browser sees the close code only of an accepted connection.
        await receive()
        await send({"type": "websocket.accept"})
        reason = refused.detail[:120]
        await send({
            "type": "websocket.close",
            "code": CLOSE_FORBIDDEN,
            "reason": reason,
        })

    async def _http(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = {name.lower() for name, _ in message.get("headers", ())}
                own = [each for each in _HEADERS if each[0] not in given]
                clock = (_CLOCK, f"{time.time():.3f}".encode())
                message["headers"] = [*message.get("headers", ()), *own, clock]
            await send(message)

        refused = self._place_refused(scope)
        most = MAX_UPLOAD_BYTES if scope["path"] == UPLOAD_PATH else self._max_body
        if refused is None and announces_more_than(scope, most):
            refused = _too_large(most)
        if refused is not None:
            await refused.response()(scope, receive, send_with_headers)
            return
        receive = limited(receive, most, _too_large(most))
        await self._app(scope, receive, send_with_headers)

    def _place_refused(self, scope: Scope) -> ProblemError | None:
        if scope["path"] in _PROBES:
            return None
        headers = Headers(scope=scope)
        host, origin = headers.get("host"), headers.get("origin")
        if not self._policy.allows_host(host):
            return ProblemError(
                403,
                "host_not_allowed",
                f"The station does not answer under the name {host!r:.80}.",
                "Use localhost, its numeric address, or a name it is configured for.",
            )
        # Refuse even reads, so that a foreign page that has got a token cannot use it.
        if not self._policy.allows_origin(origin, host):
            return ProblemError(
                403,
                "origin_not_allowed",
                f"A page of {origin!r:.80} may not use this station.",
                "Use the station's own pages or a program, or add the page's origin to "
                "api.allowed_origins of the configuration.",
            )
        return None


def _too_large(most: int) -> ProblemError:
    return ProblemError(
        413,
        "body_too_large",
        f"The body is larger than the {most} bytes allowed.",
        "Send less at once.",
        {"connection": "close"},
    )
