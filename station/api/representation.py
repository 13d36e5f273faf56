"""Send an answer to GET in full, compressed, as its head only, or as 304.

Only complete JSON answers are changed. Streams, server-sent events and files pass
unchanged, because their first byte must not wait for the last one.
"""

import asyncio
import gzip
from hashlib import blake2b

import anyio.to_thread
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LARGE = 16 * 1024
"""Size from which answers are compressed [bytes]. Smaller ones need little time in a
network, and most clients are on this machine."""
_LEVEL = 4
_NOT_SENT_AGAIN = ("content-length", "content-type")


class Representation:
    """Answers HEAD like GET, gives JSON an entity tag, and compresses large JSON.

    Args:
        app: The application; it answers GET.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or scope["method"] not in {"GET", "HEAD"}:
            await self._app(scope, receive, send)
        elif scope["method"] == "HEAD":
            await self._answer_head(scope, receive, send)
        else:
            await self._app(scope, receive, _Answer(scope, send).send)

    async def _answer_head(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let the application answer GET until the head is known, and end it then.

        So a file is not read, and an endless stream of events ends.
        """
        is_known = asyncio.Event()

        async def send_head(message: Message) -> None:
            if message["type"] == "http.response.start" and not is_known.is_set():
                await send(message)
                await send({"type": "http.response.body", "body": b""})
                is_known.set()

        answer = _Answer(scope, send_head)
        asking = asyncio.ensure_future(
            self._app({**scope, "method": "GET"}, receive, answer.send)
        )
        waiting = asyncio.ensure_future(is_known.wait())
        try:
            await asyncio.wait({asking, waiting}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            waiting.cancel()
            if not asking.done():
                asking.cancel()
            await asyncio.wait({asking})
        if not asking.cancelled():
            asking.result()  # raises the error of the application


class _Answer:
    """The answer to one GET; it holds JSON back until the JSON is complete."""

    def __init__(self, scope: Scope, send: Send) -> None:
        self._asked = Headers(scope=scope)
        self._send = send
        self._start: Message | None = None

    async def send(self, message: Message) -> None:
        """Pass a part of the answer on, or hold it back."""
        if message["type"] == "http.response.start" and _is_json(message):
            self._start = message
            return
        start, self._start = self._start, None
        if start is None:
            await self._send(message)
        elif message.get("more_body", False):
            await self._send(start)
            await self._send(message)
        else:
            await self._send_whole(start, message["body"])

    async def _send_whole(self, start: Message, body: bytes) -> None:
        headers = MutableHeaders(scope=start)
        is_own = "etag" in headers
        if not is_own:
            # The tag is weak, because the compressed and the plain answer share it.
            headers["ETag"] = f'W/"{blake2b(body, digest_size=12).hexdigest()}"'
        if self._is_known(headers["ETag"]):
            for name in _NOT_SENT_AGAIN:
                del headers[name]
            start["status"], body = 304, b""
        elif len(body) >= LARGE and not is_own:
            headers.add_vary_header("Accept-Encoding")
            if self._takes_gzip():
                body = await anyio.to_thread.run_sync(_compressed, body)
                headers["Content-Encoding"] = "gzip"
                headers["Content-Length"] = str(len(body))
        await self._send(start)
        await self._send({"type": "http.response.body", "body": body})

    def _is_known(self, tag: str) -> bool:
        known = self._asked.get("if-none-match", "")
        tags = {each.strip().removeprefix("W/") for each in known.split(",")}
        return tag.removeprefix("W/") in tags or known.strip() == "*"

    def _takes_gzip(self) -> bool:
        for each in self._asked.get("accept-encoding", "").split(","):
            coding, _, weight = each.replace(" ", "").partition(";")
            if coding.lower() in {"gzip", "*"}:
                return weight not in {"q=0", "q=0.0", "q=0.00", "q=0.000"}
        return False


def _is_json(start: Message) -> bool:
    headers = Headers(raw=start["headers"])
    kind = headers.get("content-type", "").partition(";")[0]
    return start["status"] == 200 and kind == "application/json"


def _compressed(body: bytes) -> bytes:
    return gzip.compress(body, _LEVEL, mtime=0)
