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
"""How often an open stream looks whether its session has expired [s]."""
MAX_GRANTS = 512
"""Most cookies, and most tickets, that are kept for each role; of the same role the
oldest are dropped first."""


class Role(Enum):
    """Role of the bearer of a token."""

    VIEWER = "viewer"
    """Read everything, and stop the robot."""
    AGENT = "agent"
    """A program that acts for a person: ask for motion, within the agents' envelope."""
    OPERATOR = "operator"
    """Everything."""

    def includes(self, needed: "Role") -> bool:
        """Return whether this role may do everything that `needed` may do."""
        return self in (Role.OPERATOR, needed) or needed is Role.VIEWER


class LoginSession:
    """A browser that has logged in. For one event loop.

    Args:
        role: Role, which decides on its rights.
        clock: Ages it.
        token: The named token that it was opened with, with which it ends.

    Attributes:
        role: The same.
        token: The same.
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
        """End the session, and with it the streams that were opened by it."""
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
        session: The browser's session, also when a ticket of that session was shown;
            None for a token.
        token: The named token, also behind a session; None for the tokens that the
            station makes itself.
    """

    role: Role
    session: LoginSession | None = None
    token: NamedToken | None = None

    @property
    def name(self) -> str:
        """Name of the bearer; the role, for tokens that the station makes itself."""
        return self.role.value if self.token is None else self.token.name

    def has_ended(self) -> bool:
        """Return whether the access was withdrawn; the station's own tokens never."""
        ends = (self.session, self.token)
        return any(end is not None and end.has_ended() for end in ends)

    async def wait_for_end(self) -> None:
        """Wait until the access is withdrawn; for the station's own tokens, forever."""
        ends = [end.wait_for_end() for end in (self.session, self.token) if end]
        await until_first(*(ends or [_never()]))


async def until_first(*ends: Coroutine[Any, Any, object]) -> None:
    """Wait until the first of some coroutines returns; the others are cancelled."""
    tasks = [asyncio.ensure_future(end) for end in ends]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()


async def _never() -> None:
    await asyncio.Event().wait()


class _Tickets:
    """Random names, each of which proves an access once and for a short time."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._issued: dict[str, tuple[Access, float]] = {}

    def issue(self, access: Access) -> str:
        now = self._clock.now()
        for name, (_, expiry) in list(self._issued.items()):
            if expiry <= now:
                del self._issued[name]
        # Each role has its own share: viewers cannot displace an operator's ticket.
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
        # Each role has its own share: viewers cannot displace an operator's session.
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
        operator_token: Lets its bearer do everything; random when left out.
        viewer_token: Lets its bearer look and stop; random when left out.
        clock: Ages cookies and tickets.

    Attributes:
        operator_token: The token.
        viewer_token: The token.
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
        """Return the role of a token, in the same time for every wrong token."""
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
            token: The named token that opens it.
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

        A bearer token, where there is one, decides alone; the cookie is not looked at.
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
