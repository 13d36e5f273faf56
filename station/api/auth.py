"""Authentication: two tokens, cookies for browsers, tickets for WebSockets."""

import hmac
import secrets
from collections.abc import Mapping
from enum import Enum
from http.cookies import CookieError, SimpleCookie

from station.core.clock import Clock, SystemClock

TICKET_LIFETIME = 30.0
"""How long after its issue a ticket can open a WebSocket [s]."""
SESSION_LIFETIME = 12 * 3600.0
"""How long a cookie is valid [s]."""
MAX_GRANTS = 1024
"""Most cookies, and most tickets, that are kept; the oldest are dropped first."""


class Role(Enum):
    """What the bearer of a token may do."""

    VIEWER = "viewer"
    """Read everything, and stop the robot."""
    OPERATOR = "operator"
    """Everything."""

    def includes(self, needed: "Role") -> bool:
        """Return whether this role may do everything that `needed` may do."""
        return self is Role.OPERATOR or needed is Role.VIEWER


class _Grants:
    """Random names, each of which proves a role for a limited time. Not thread-safe."""

    def __init__(self, clock: Clock, lifetime: float) -> None:
        self._clock = clock
        self._lifetime = lifetime
        self._roles: dict[str, tuple[Role, float]] = {}

    def issue(self, role: Role) -> str:
        now = self._clock.now()
        for name, (_, expiry) in list(self._roles.items()):
            if expiry <= now or len(self._roles) >= MAX_GRANTS:
                del self._roles[name]
        name = secrets.token_urlsafe(32)
        self._roles[name] = (role, now + self._lifetime)
        return name

    def role(self, name: str) -> Role | None:
        role, expiry = self._roles.get(name, (None, 0.0))
        return role if expiry > self._clock.now() else None

    def revoke(self, name: str) -> None:
        self._roles.pop(name, None)


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
        self._sessions = _Grants(clock, SESSION_LIFETIME)
        self._tickets = _Grants(clock, TICKET_LIFETIME)

    def role_of_token(self, token: str) -> Role | None:
        """Return the role of a token, in the same time for every wrong token."""
        given = token.encode()
        operator = hmac.compare_digest(given, self.operator_token.encode())
        viewer = hmac.compare_digest(given, self.viewer_token.encode())
        if operator:
            return Role.OPERATOR
        return Role.VIEWER if viewer else None

    def open_session(self, role: Role) -> str:
        """Return the value of a new session cookie."""
        return self._sessions.issue(role)

    def close_session(self, cookie: str) -> None:
        """Revoke a session cookie."""
        self._sessions.revoke(cookie)

    def issue_ticket(self, role: Role) -> str:
        """Return a ticket that opens one WebSocket."""
        return self._tickets.issue(role)

    def redeem_ticket(self, ticket: str) -> Role | None:
        """Return the role of a ticket and revoke the ticket."""
        role = self._tickets.role(ticket)
        self._tickets.revoke(ticket)
        return role

    def session_of(self, headers: Mapping[str, str]) -> str:
        """Return the session cookie in a request's headers; empty without a cookie."""
        try:
            cookies = SimpleCookie(headers.get("cookie", ""))
        except CookieError:
            return ""
        morsel = cookies.get(self.cookie_name)
        return "" if morsel is None else morsel.value

    def role_of_headers(self, headers: Mapping[str, str]) -> Role | None:
        """Return the role that a request's headers prove; None when they prove no role.

        A bearer token, where there is one, decides alone; the cookie is not looked at.
        """
        authorization = headers.get("authorization")
        if authorization is not None:
            scheme, _, token = authorization.partition(" ")
            known = scheme.lower() == "bearer"
            return self.role_of_token(token.strip()) if known else None
        return self._sessions.role(self.session_of(headers))
