"""Name every request, so that log, audit and client can refer to the same request.

A client may give the name in the header `X-Request-ID`; otherwise the server makes one.
The answer carries it in the same header.
"""

import logging
import re
import uuid
from contextvars import ContextVar
from time import monotonic

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from typing_extensions import override

HEADER = "X-Request-ID"
# The name goes into the log and into events, so it must not hold line breaks.
_ACCEPTED = re.compile(r"[A-Za-z0-9._:-]{1,64}")
_READS = frozenset({"GET", "HEAD", "OPTIONS"})
_request_id: ContextVar[str | None] = ContextVar("request_id", default=None)
_log = logging.getLogger(__name__)


def present_request_id() -> str | None:
    """Return the name of the request that is being answered; None outside of one.

    Works in the worker threads of a request, too.
    """
    return _request_id.get()


class RequestId:
    """Names every request and WebSocket, and logs the requests that change something.

    A name that a client gives is used when it has 1 to 64 letters, digits or `._:-`;
    any other name is replaced, because names go into logs.

    Args:
        app: The application.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, and give its name to logs and to the answer's header."""
        if scope["type"] not in {"http", "websocket"}:
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get(HEADER, "")
        name = given if _ACCEPTED.fullmatch(given) else uuid.uuid4().hex
        began, status = monotonic(), 0

        async def send_with_name(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                header = (HEADER.lower().encode(), name.encode())
                message["headers"] = [*message.get("headers", ()), header]
            await send(message)

        token = _request_id.set(name)
        try:
            await self._app(scope, receive, send_with_name)
        finally:
            if scope["type"] == "http":
                _note(scope, status, monotonic() - began)
            # A connection that is kept alive serves the next request in the same
            # context.
            _request_id.reset(token)


def _note(scope: Scope, status: int, duration: float) -> None:
    """Log a request that changes something or was refused."""
    # Pages poll several times a second; the log holds only requests that change
    # something.
    if scope["method"] in _READS and status < 400:
        return
    line = "%s %s: %d in %.1f ms"
    _log.info(line, scope["method"], scope["path"], status, 1e3 * duration)


class RequestIdFilter(logging.Filter):
    """Gives every record of a log the name of its request as `request_id`."""

    @override
    def filter(self, record: logging.LogRecord) -> bool:
        """Write the name into `record`, and accept the record."""
        record.request_id = present_request_id()
        return True
