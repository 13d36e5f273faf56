"""Browser sessions of the gateway: who has logged in, and in which role."""

import asyncio
import contextlib
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

SESSION_LIFETIME = 12 * 3600.0
"""How long a login lasts [s]; every request renews it."""

EXPIRY_PERIOD = 1.0
"""How often an open socket looks whether its session has expired [s]."""


class Role(Enum):
    """What a browser may do: watch, or also act."""

    VIEWER = "viewer"
    OPERATOR = "operator"


@dataclass(frozen=True, slots=True)
class Session:
    """One logged-in browser.

    Attributes:
        identifier: Random value of its cookie.
        role: What it may do.
        token: The named token that it logged in with, which never leaves the gateway
            but for the station; empty for a token of the station's start, for which the
            role stands.
        key: Names the session where its cookie must not be known, as to Viser.
        closed: Set when the session is closed, or dropped for a newer one.
    """

    identifier: str
    role: Role
    token: str = field(default="", repr=False)
    key: str = field(default_factory=lambda: secrets.token_hex(8))
    closed: asyncio.Event = field(default_factory=asyncio.Event, compare=False)


class Sessions:
    """Keeps the logged-in browsers; forgets those that stay away.

    The station's token itself never becomes a cookie: a stolen cookie is worth
    nothing at the API and nothing after a restart of the dashboard.

    Args:
        now: Monotonic clock [s].
        limit: Most sessions kept for each role; of the same role the oldest goes first,
            so that no viewer can end an operator's session.
    """

    def __init__(
        self, now: Callable[[], float] = time.monotonic, limit: int = 256
    ) -> None:
        self._now = now
        self._limit = limit
        self._sessions: dict[str, tuple[Session, float]] = {}

    def open(self, role: Role, token: str = "") -> Session:
        """Start a session and return it.

        Args:
            role: What the browser may do.
            token: The named token with which it has logged in; empty for a token of
                the station's start.
        """
        self._forget_expired()
        alike = [one for one, _ in self._sessions.values() if one.role is role]
        for session in alike[: max(0, len(alike) + 1 - self._limit)]:
            self.close(session.identifier)
        session = Session(secrets.token_urlsafe(32), role, token)
        self._sessions[session.identifier] = (session, self._now())
        return session

    def find(self, identifier: str | None) -> Session | None:
        """Return the session behind a cookie and renew it, or None."""
        self._forget_expired()
        entry = self._sessions.pop(identifier or "", None)
        if entry is None:
            return None
        session = entry[0]
        self._sessions[session.identifier] = (session, self._now())
        return session

    def close(self, identifier: str | None) -> None:
        """End a session; one that is not known is ended already."""
        entry = self._sessions.pop(identifier or "", None)
        if entry is not None:
            entry[0].closed.set()

    async def wait_for_end(self, session: Session) -> None:
        """Return when a session was closed or has expired; does not renew it."""
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
