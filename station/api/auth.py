"""Authentication: the station's tokens, cookies for browsers, WebSocket tickets."""

import asyncio
import contextlib
import hmac
import secrets
from collections.abc import Coroutine, Mapping
from dataclasses import dataclass
from enum import Enum
from http.cookies import CookieError, SimpleCookie
from typing import Any

from station.api.named_tokens import NamedToken, NamedTokens
from station.core.clock import Clock, SystemClock

TICKET_LIFETIME = 30.0
"""How long after its issue a ticket can open a WebSocket [s]."""
SESSION_LIFETIME = 12 * 3600.0
"""How long a cookie is valid [s]."""
EXPIRY_PERIOD = 1.0
"""Time between two checks whether the session of an open stream has expired [s]."""
MAX_GRANTS = 512
"""Most cookies, and most tickets, that are kept for each role; the oldest of a role are
dropped first."""


class Role(Enum):
    """Role of the bearer of a token."""

    VIEWER = "viewer"
    """May read everything, and stop the robot."""
    AGENT = "agent"
    """A program that acts for a person, and may ask for motion within the envelope."""
    OPERATOR = "operator"
    """May do everything."""

    def includes(self, needed: "Role") -> bool:
        """Return whether this role may do everything that `needed` may do."""
        return self in (Role.OPERATOR, needed) or needed is Role.VIEWER


class LoginSession:
    """A browser that has logged in. Use it in one event loop only.

    Args:
        role: Role, which decides on its rights.
        clock: Clock that measures its age.
        token: The named token that opened the session; the session ends with the token.

    Attributes:
        role: As given.
        token: As given.
        cookie: The random value of its cookie.
    """

    def __init__(
        self, role: Role, clock: Clock, token: NamedToken | None = None
    ) -> None:
        self.role = role
        self.token = token
        self.cookie = secrets.token_urlsafe(32)
        self._clock = clock
        self._expiry = clock.now() + SESSION_LIFETIME
        self._closed = asyncio.Event()

    def has_ended(self) -> bool:
        """Return whether the session was closed or has expired."""
        if self.token is not None and self.token.has_ended():
            return True
        return self._closed.is_set() or self._clock.now() >= self._expiry

    def close(self) -> None:
        """End the session and all streams that it has opened."""
        self._closed.set()

    async def wait_for_end(self) -> None:
        """Wait until the session is closed or has expired."""
        while not self.has_ended():
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._closed.wait(), EXPIRY_PERIOD)


@dataclass(frozen=True, slots=True)
class Access:
    """Rights of a request or a WebSocket, and their proof.

    Attributes:
        role: Role, which decides on its rights.
        session: The browser's session, also for a ticket of the session; None for a
            token.
        token: The named token, also that of a session; None for the station's own
            tokens.
    """

    role: Role
    session: LoginSession | None = None
    token: NamedToken | None = None

    @property
    def name(self) -> str:
        """Name of the bearer; for the station's own tokens, the role."""
        return self.role.value if self.token is None else self.token.name

    def has_ended(self) -> bool:
        """Return whether the access has ended; the station's own tokens never end."""
        ends = (self.session, self.token)
        return any(end is not None and end.has_ended() for end in ends)

    async def wait_for_end(self) -> None:
        """Wait until the access ends; for the station's own tokens, for ever."""
        ends = [end.wait_for_end() for end in (self.session, self.token) if end]
        await until_first(*(ends or [_never()]))


async def until_first(*ends: Coroutine[Any, Any, object]) -> None:
    """Wait until the first of some coroutines returns, and cancel the others."""
    tasks = [asyncio.ensure_future(end) for end in ends]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()


async def _never() -> None:
    await asyncio.Event().wait()


class _Tickets:
    """Tickets: random names that prove an access once, for a short time."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._issued: dict[str, tuple[Access, float]] = {}

    def issue(self, access: Access) -> str:
        now = self._clock.now()
        for name, (_, expiry) in list(self._issued.items()):
            if expiry <= now:
                del self._issued[name]
        # Each role has its own limit, so viewers cannot displace an operator's ticket.
        alike = [n for n, (one, _) in self._issued.items() if one.role is access.role]
        if len(alike) >= MAX_GRANTS:
            del self._issued[alike[0]]
        name = secrets.token_urlsafe(32)
        self._issued[name] = (access, now + TICKET_LIFETIME)
        return name

    def redeem(self, name: str) -> Access | None:
        access, expiry = self._issued.pop(name, (None, 0.0))
        if access is None or expiry <= self._clock.now() or access.has_ended():
            return None
        return access


class _Sessions:
    """The browsers that have logged in, by their cookie."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._open: dict[str, LoginSession] = {}

    def open(self, role: Role, token: NamedToken | None) -> str:
        for session in list(self._open.values()):
            if session.has_ended():
                self.close(session.cookie)
        # Each role has its own limit, so viewers cannot displace an operator's session.
        alike = [one.cookie for one in self._open.values() if one.role is role]
        if len(alike) >= MAX_GRANTS:
            self.close(alike[0])
        session = LoginSession(role, self._clock, token)
        self._open[session.cookie] = session
        return session.cookie

    def find(self, cookie: str) -> LoginSession | None:
        session = self._open.get(cookie)
        return None if session is None or session.has_ended() else session

    def close(self, cookie: str) -> None:
        session = self._open.pop(cookie, None)
        if session is not None:
            session.close()


class Authenticator:
    """Checks tokens, cookies and tickets. Used in the server's event loop only.

    Args:
        operator_token: Token with all rights; None for a random one.
        viewer_token: Token with the rights to read and to stop; None for a random one.
        clock: Clock that measures the age of cookies and tickets.

    Attributes:
        operator_token: The operator's token.
        viewer_token: The viewer's token.
        cookie_name: Name of the session cookie; differs between stations, because
            browsers share cookies among the ports of a host.
        named: The named tokens.
    """

    def __init__(
        self,
        operator_token: str | None = None,
        viewer_token: str | None = None,
        *,
        clock: Clock | None = None,
    ) -> None:
        clock = clock or SystemClock()
        self.operator_token = operator_token or secrets.token_urlsafe(32)
        self.viewer_token = viewer_token or secrets.token_urlsafe(32)
        self.cookie_name = f"station_{secrets.token_hex(4)}"
        self.named = NamedTokens()
        self._sessions = _Sessions(clock)
        self._tickets = _Tickets(clock)

    def role_of_token(self, token: str) -> Role | None:
        """Return the role of a token; all wrong tokens take the same time."""
        given = token.encode()
        operator = hmac.compare_digest(given, self.operator_token.encode())
        viewer = hmac.compare_digest(given, self.viewer_token.encode())
        if operator:
            return Role.OPERATOR
        return Role.VIEWER if viewer else None

    def access_of_token(self, token: str) -> Access | None:
        """Return the access that a token grants; None for an unknown token."""
        role = self.role_of_token(token)
        if role is not None:
            return Access(role)
        named = self.named.find(token)
        return None if named is None else Access(Role(named.role), token=named)

    def open_session(self, role: Role, token: NamedToken | None = None) -> str:
        """Return the value of a new session cookie.

        Args:
            role: Role of the session.
            token: The named token that opens the session.
        """
        return self._sessions.open(role, token)

    def close_session(self, cookie: str) -> None:
        """Revoke a session cookie; its tickets and its open streams end with it."""
        self._sessions.close(cookie)

    def issue_ticket(self, access: Access) -> str:
        """Return a ticket that opens one WebSocket with the access of its requester."""
        return self._tickets.issue(access)

    def redeem_ticket(self, ticket: str) -> Access | None:
        """Return the access that a ticket proves, and revoke the ticket."""
        return self._tickets.redeem(ticket)

    def session_of(self, headers: Mapping[str, str]) -> str:
        """Return the session cookie in a request's headers; empty without a cookie."""
        try:
            cookies = SimpleCookie(headers.get("cookie", ""))
        except CookieError:
            return ""
        morsel = cookies.get(self.cookie_name)
        return "" if morsel is None else morsel.value

    def access_of_headers(self, headers: Mapping[str, str]) -> Access | None:
        """Return the access that a request's headers prove; None when they prove none.

        If the headers have a bearer token, the cookie is ignored.
        """
        authorization = headers.get("authorization")
        if authorization is not None:
            scheme, _, token = authorization.partition(" ")
            known = scheme.lower() == "bearer"
            return self.access_of_token(token.strip()) if known else None
        session = self._sessions.find(self.session_of(headers))
        if session is None:
            return None
        return Access(session.role, session, session.token)
