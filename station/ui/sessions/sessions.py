"""Browser sessions of the gateway: logins, their roles, and requests under them."""

import asyncio
import contextlib
import secrets
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from station.client import ApiError

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.websockets import WebSocket

SESSION_LIFETIME = 12 * 3600.0
"""Duration of a login [s]; every request renews it."""

SAVE_PERIOD = 60.0
"""Time between two saves of when the sessions were last used [s]."""

EXPIRY_PERIOD = 1.0
"""Time between two checks whether the session of an open socket has ended [s]."""


class Role(Enum):
    """The permission of a browser: to watch, or also to act."""

    VIEWER = "viewer"
    OPERATOR = "operator"


@dataclass(frozen=True, slots=True)
class BrowserSession:
    """One logged-in browser.

    Attributes:
        identifier: Random value of its cookie.
        role: Its role.
        token: The named token of its login, which the gateway sends to the station
            only; empty for a token that the station makes at its start, because then
            the role suffices.
        key: Name of the session for programs that must not know its cookie, e.g. Viser.
        closed: Set when the session is closed, or dropped for a newer one.
    """

    identifier: str
    role: Role
    token: str = field(default="", repr=False)
    key: str = field(default_factory=lambda: secrets.token_hex(8))
    closed: asyncio.Event = field(default_factory=asyncio.Event, compare=False)


@dataclass(frozen=True, slots=True)
class KeptSession:
    """A session as it outlives the dashboard.

    Attributes:
        identifier: Random value of its cookie.
        role: Its role.
        token: As `BrowserSession.token`.
        used_at: When it was used last, in the time of `Sessions`.
    """

    identifier: str
    role: Role
    token: str = field(repr=False)
    used_at: float


class SessionStore(Protocol):
    """Keeps sessions beyond the life of this process."""

    def load(self) -> Sequence[KeptSession]:
        """Return the saved sessions, oldest first."""
        ...

    def save(self, sessions: Sequence[KeptSession]) -> None:
        """Save the sessions, oldest first."""
        ...

    def move_to(self, station: str) -> None:
        """Keep the sessions for the station at this address from now on."""
        ...


class Sessions:
    """Keeps the logged-in browsers; forgets those without requests for too long.

    The station's token itself never becomes a cookie: a stolen cookie is worth
    nothing at the API.

    Args:
        now: Clock [s] that goes on while no dashboard runs.
        limit: Most sessions kept for each role; of the same role the oldest goes first,
            so that no viewer can end an operator's session.
        store: File in which the sessions outlive a dashboard; None keeps none.
    """

    def __init__(
        self,
        now: Callable[[], float] = time.time,
        limit: int = 256,
        store: SessionStore | None = None,
    ) -> None:
        self._now = now
        self._limit = limit
        self._store = store
        self._saved_at = now()
        self._sessions: dict[str, tuple[BrowserSession, float]] = {}
        for kept in () if store is None else store.load():
            session = BrowserSession(kept.identifier, kept.role, kept.token)
            # A clock that was set back must not let a session live longer.
            self._sessions[kept.identifier] = (session, min(kept.used_at, now()))
        self._forget_expired()

    def open(self, role: Role, token: str = "") -> BrowserSession:
        """Start a session and return it.

        Args:
            role: The role of the browser.
            token: The named token with which it has logged in; empty for a token that
                the station makes at its start.
        """
        self._forget_expired()
        # Of one role alone: a viewer could otherwise end the sessions of operators by
        # logging in often enough.
        alike = [one for one, _ in self._sessions.values() if one.role is role]
        for session in alike[: max(0, len(alike) + 1 - self._limit)]:
            self.close(session.identifier)
        session = BrowserSession(secrets.token_urlsafe(32), role, token)
        self._sessions[session.identifier] = (session, self._now())
        self._save()
        return session

    def find(self, identifier: str | None) -> BrowserSession | None:
        """Return the session behind a cookie and renew it, or None."""
        self._forget_expired()
        entry = self._sessions.pop(identifier or "", None)
        if entry is None:
            return None
        session = entry[0]
        self._sessions[session.identifier] = (session, self._now())
        # A page asks three times a second; not each of them is worth a write to disk.
        if self._now() - self._saved_at > SAVE_PERIOD:
            self._save()
        return session

    def named(self, key: str) -> BrowserSession | None:
        """Return the session of that key, without renewing it; callable by any thread.

        Args:
            key: `BrowserSession.key`.
        """
        # A copy, because the gateway's thread changes the table meanwhile.
        for session, _ in list(self._sessions.values()):
            if session.key == key:
                return session
        return None

    def close(self, identifier: str | None) -> None:
        """End a session; nothing happens if it has ended already."""
        entry = self._sessions.pop(identifier or "", None)
        if entry is not None:
            entry[0].closed.set()
            self._save()

    def move_to(self, station: str) -> None:
        """Keep the sessions for the station at this address from now on."""
        if self._store is not None:
            self._store.move_to(station)
            self._save()

    def _save(self) -> None:
        self._saved_at = self._now()
        if self._store is not None:
            self._store.save([
                KeptSession(session.identifier, session.role, session.token, used_at)
                for session, used_at in self._sessions.values()
            ])

    async def wait_for_end(self, session: BrowserSession) -> None:
        """Wait until a session is closed or has expired; does not renew it."""
        while not session.closed.is_set():
            self._forget_expired()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(session.closed.wait(), EXPIRY_PERIOD)

    def _forget_expired(self) -> None:
        oldest = self._now() - SESSION_LIFETIME
        expired = [
            key for key, (_, used_at) in self._sessions.items() if used_at < oldest
        ]
        for key in expired:
            self.close(key)


class RefusedError(Exception):
    """A refusal of a request of the page.

    Args:
        status: HTTP status.
        code: The reason, for programs.
        detail: The reason, for people.
        remedy: Advice to the user; empty if nothing helps.
    """

    def __init__(self, status: int, code: str, detail: str, remedy: str = "") -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.remedy = remedy

    def answer(self) -> JSONResponse:
        """Return the refusal in the form of the station's refusals."""
        body = {
            "status": self.status,
            "code": self.code,
            "detail": self.detail,
            "remedy": self.remedy,
        }
        return JSONResponse(body, self.status, media_type="application/problem+json")


class Body(BaseModel):
    """The body of a request of the page."""

    model_config = ConfigDict(extra="forbid", strict=True)


_Wanted = TypeVar("_Wanted", bound=Body)


class FindSession(Protocol):
    """Finds the session of a connection."""

    def __call__(self, connection: "Request | WebSocket") -> BrowserSession | None:
        """Return the session of a connection, or None."""
        ...


class SessionRoutes:
    """Makes routes that answer logged-in sessions only.

    Args:
        find: Returns the session of a connection.
    """

    def __init__(self, find: FindSession) -> None:
        self.find = find

    def route(
        self,
        method: str,
        path: str,
        answer: "Callable[[BrowserSession, Request], Awaitable[Response]]",
        *,
        operators_only: bool = False,
    ) -> Route:
        """Return a route.

        Args:
            method: The HTTP method.
            path: The path.
            answer: Answers a request. Its `RefusedError` and `ApiError` become
                refusals.
            operators_only: Whether viewers are refused.
        """

        async def endpoint(request: "Request") -> Response:
            session = self.find(request)
            try:
                if session is None:
                    raise RefusedError(401, "no_session", "Log in first.")
                if operators_only and session.role is not Role.OPERATOR:
                    raise RefusedError(403, "forbidden", "Viewers only watch.")
                return await answer(session, request)
            except ApiError as error:
                status = error.status or 502
                detail, remedy = error.detail, error.remedy
                return RefusedError(status, error.code, detail, remedy).answer()
            except RefusedError as refusal:
                return refusal.answer()

        return Route(path, endpoint, methods=[method])

    def route_of(
        self,
        method: str,
        path: str,
        kind: type[_Wanted],
        answer: Callable[[BrowserSession, _Wanted], Awaitable[Response]],
        *,
        operators_only: bool = False,
    ) -> Route:
        """Return a route whose requests have a body; as `route`.

        Args:
            method: The HTTP method.
            path: The path.
            kind: The model of the body; another body is refused.
            answer: Answers a request with this body.
            operators_only: Whether viewers are refused.
        """

        async def read_and_answer(
            session: BrowserSession, request: "Request"
        ) -> Response:
            try:
                wanted = kind.model_validate_json(await request.body())
            except ValidationError as error:
                first = error.errors()[0]
                place = ".".join(map(str, first["loc"])) or "the body"
                detail = f"{place}: {first['msg']}."
                raise RefusedError(422, "invalid_request", detail) from error
            return await answer(session, wanted)

        return self.route(method, path, read_and_answer, operators_only=operators_only)
