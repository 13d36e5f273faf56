"""`Idempotency-Key`: a request that is sent twice is carried out once.

A client that has lost the connection cannot know whether its request was carried out.
It sends the request again with the same key, and gets the answer to the first request.
"""

import asyncio
import hashlib
import re
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Coroutine
from dataclasses import dataclass, field
from typing import Annotated, Any

from fastapi import Depends, Header, Request, Response
from starlette.types import Message
from typing_extensions import override

from station.api.audit import note_access
from station.api.auth import Role
from station.api.control import ControlHeldError
from station.api.errors import ProblemError, station_error_response
from station.api.json_route import JsonRoute
from station.api.services import services_of
from station.core.errors import StationError
from station.wire.protocol import KEY_HEADER, REPLAYED_HEADER

LIFETIME = 600.0
"""How long an answer is kept [s]."""
MOST_KEYS = 1024
"""Most answers that are kept; beyond it, the oldest are deleted first."""
KEY_PATTERN = r"^[!-~]{1,200}$"
"""A key is 1 to 200 visible ASCII characters."""


async def idempotency_key(
    _: Annotated[
        str | None,
        Header(
            alias=KEY_HEADER,
            pattern=KEY_PATTERN,
            examples=["5f0c6f0e-load-pose"],
            description="Random name of the request, up to 200 visible ASCII "
            "characters. A repetition with the same key within 10 minutes is not "
            "carried out again, but gets the same answer.",
        ),
    ] = None,
) -> None:
    """Declare the header, which `IdempotentRoute` reads before the request."""


Idempotent = Depends(idempotency_key)
"""Dependency of a route that carries out one request for each key."""


@dataclass(eq=False, slots=True)
class _Kept:
    """A request with a key, and its answer.

    Attributes:
        fingerprint: Hash of method, address and body.
        what: Method and path.
        began: When the request came [s, monotonic].
        answer: The answer; None while the request is being carried out.
        ended: Set when the request has ended, with or without a kept answer.
    """

    fingerprint: bytes
    what: str
    began: float
    answer: Response | None = None
    ended: asyncio.Event = field(default_factory=asyncio.Event)


class IdempotentAnswers:
    """The answers that are kept for repetitions. Use it in one event loop only.

    Args:
        now: Monotonic clock [s].
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._kept: OrderedDict[tuple[str, str], _Kept] = OrderedDict()

    def __len__(self) -> int:
        return len(self._kept)

    async def answer(
        self,
        who: str,
        key: str,
        request: Request,
        carry_out: Callable[[], Awaitable[Response]],
    ) -> Response:
        """Carry a request out, or return the answer to the first request with its key.

        A repetition that comes while the first request is being carried out waits for
        its end. The answer may be a refusal by the station. No answer is kept of a
        request that is refused before it begins (malformed, not permitted).

        Args:
            who: Name of the caller, because each caller has keys of its own.
            key: The key.
            request: The request.
            carry_out: Function that carries the request out.

        Raises:
            ProblemError: The key was used for another request.
        """
        what = f"{request.method} {request.url.path}"
        content = f"{what}?{request.url.query}\n".encode() + await request.body()
        fingerprint = hashlib.sha256(content).digest()
        self._forget_old()
        name = (who, key)
        while (kept := self._kept.get(name)) is not None:
            if kept.fingerprint != fingerprint:
                error = _reused(key, kept.what)
                raise error
            if kept.answer is not None:
                return _again(kept.answer)
            await kept.ended.wait()
        mine = self._kept[name] = _Kept(fingerprint, what, self._now())
        try:
            mine.answer = await _answer_of(carry_out)
        finally:
            if mine.answer is None:
                del self._kept[name]
            mine.ended.set()
        return mine.answer

    def _forget_old(self) -> None:
        oldest = self._now() - LIFETIME
        for name, kept in list(self._kept.items()):
            is_too_much = len(self._kept) >= MOST_KEYS
            if kept.began > oldest and not is_too_much:
                return
            # Keep requests that are being carried out: without them a repetition would
            # be carried out, too.
            if kept.answer is not None:
                del self._kept[name]


async def _answer_of(carry_out: Callable[[], Awaitable[Response]]) -> Response:
    """Return the answer, even if it is a refusal by the station.

    Raises:
        ControlHeldError: Nothing has begun, so the request may be sent again.
    """
    try:
        return await carry_out()
    except ControlHeldError:
        raise
    except StationError as error:
        return station_error_response(error)


def _again(answer: Response) -> Response:
    copy = Response(bytes(answer.body), answer.status_code)
    copy.raw_headers = list(answer.raw_headers)
    copy.headers[REPLAYED_HEADER] = "true"
    return copy


def _reused(key: str, what: str) -> ProblemError:
    return ProblemError(
        422,
        "idempotency_key_reused",
        f"The {KEY_HEADER} '{key}' belongs to another request ({what}); method, "
        "address and body of a repetition must be the same, byte for byte.",
        "Use a new random key for each new request. Nothing changed.",
    )


async def _read(request: Request) -> Request:
    """Read the body of a request; return a request whose body can be read again."""
    parts: list[Message] = [{"type": "http.request", "body": await request.body()}]

    async def receive() -> Message:
        return parts.pop() if parts else await request.receive()

    return Request(request.scope, receive)


class IdempotentRoute(JsonRoute):
    """A route that carries out each key's request once, if it is `Idempotent`."""

    @override
    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        handle = super().get_route_handler()
        if all(each is not Idempotent for each in self.dependencies):
            return handle

        async def handle_once(request: Request) -> Response:
            key = request.headers.get(KEY_HEADER)
            services = services_of(request)
            access = services.authenticator.access_of_headers(request.headers)
            # Without rights or with a malformed key, handle the request as one without
            # a key, which refuses it.
            if key is None or re.fullmatch(KEY_PATTERN, key) is None:
                return await handle(request)
            if access is None or not access.role.includes(Role.OPERATOR):
                return await handle(request)
            note_access(request, access)
            repeatable = await _read(request)
            return await services.idempotent_answers.answer(
                access.name, key, request, lambda: handle(repeatable)
            )

        return handle_once
