"""The credentials of each session at the station: an address, a token, a lease.

None of them ever reaches a page. Any thread may ask; only the gateway's event loop
changes anything.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass

from station.client import ApiError, AsyncStationClient
from station.client.connection import RequestDeadline
from station.ui.link.station_access import StationAccess
from station.ui.sessions.sessions import BrowserSession, Role, Sessions
from station.wire import ControlState, ExternalForce
from station.wire.protocol import LEASE_HEADER

BEGIN_WITHIN = 3.0
"""Longest time between the request of a change and its begin [s]."""
_REQUEST_TIMEOUT = 2.0
_NO_TOKEN = "nobodys-token"


@dataclass(frozen=True, slots=True)
class _Lease:
    session: BrowserSession
    key: str
    deadline: float


class SessionAccess:
    """The credentials of the dashboard's sessions at the station.

    A session that logged in with a token that the station makes at every start keeps no
    token: its requests carry the present token for its role, also after a restart of
    the station. A session of a named token keeps that token.

    Args:
        station: How to reach the station.
        lease_changed: Called with the lease that some session of this dashboard holds,
            or None, whenever the lease changes.
        now: Monotonic clock [s].
        follows: Whether `move_to` is called at every start of the station. If not, only
            refusals show that a station was started anew.
        ca: File of the certificates to trust with https; None for those of the station
            on this machine, or of the system.

    Attributes:
        deadline: Lets the station refuse a change that a person asked for long ago.
    """

    def __init__(
        self,
        station: StationAccess,
        lease_changed: Callable[[str | None], None] = lambda _: None,
        now: Callable[[], float] = time.monotonic,
        *,
        follows: bool = False,
        ca: str | None = None,
    ) -> None:
        self.deadline = RequestDeadline(BEGIN_WITHIN)
        self._ca = ca
        self._station = station
        self._follows = follows
        self._is_lost = False
        self._is_back = asyncio.Event()
        self._is_back.set()
        self._lease_changed = lease_changed
        self._now = now
        self._lease: _Lease | None = None
        self._shared: AsyncStationClient | None = None

    async def close(self) -> None:
        """Close the connections of `acting_for`."""
        if self._shared is not None:
            await self._shared.close()

    @property
    def url(self) -> str:
        """The station's API."""
        return self._station.url

    @property
    def is_lost(self) -> bool:
        """Return whether the station has ended and no other has taken its place yet."""
        return self._is_lost

    async def wait_for_station(self) -> None:
        """Wait while `is_lost`; in the gateway's event loop."""
        await self._is_back.wait()

    def move_to(self, station: StationAccess | None) -> None:
        """Serve another station from now on, without a lease.

        Args:
            station: How to reach it; None while the former one has ended and it is not
                known which comes next.
        """
        self._is_lost = station is None
        self._station = station or self._station
        # Control was given by the station that has ended.
        self._set(None)
        if station is None:
            self._is_back.clear()
        else:
            self._is_back.set()

    def own_token(self, token: str) -> str:
        """Return the token that a session keeps from its login.

        Args:
            token: The token.

        Returns:
            The token; empty for a token that the station makes anew at every start,
            since the role of the session stands for it.
        """
        made = {self._station.token, self._station.viewer_token} - {""}
        return "" if token in made else token

    def token_of(self, session: BrowserSession) -> str | None:
        """Return the token that a session's requests carry; None while there is none.

        The token has the role of the session: a viewer is a viewer at the station,
        too. While `is_lost`, a request gets no token of the station that has ended.
        """
        # Another program may answer at the address of a station that has ended.
        if self._is_lost:
            return None
        if session.token:
            return session.token
        if session.role is Role.OPERATOR:
            return self._station.token
        return self._station.viewer_token or _NO_TOKEN

    def is_withdrawn(self, session: BrowserSession, token: str | None) -> bool:
        """Return whether a session is over because the station refuses its token.

        A station that was started anew refuses the tokens that its predecessor made.
        This ends no session, because the dashboard soon gets the new tokens.

        Args:
            session: BrowserSession whose request was refused.
            token: The token of the request.
        """
        if token is None or token != self.token_of(session):
            return False
        return bool(session.token) or not self._follows

    def lease_of(self, session: BrowserSession) -> str | None:
        """Return the lease that a session acts under; None without one."""
        lease = self._present()
        return lease.key if lease is not None and lease.session is session else None

    def headers_of(self, session: BrowserSession) -> dict[str, str]:
        """Return the headers that prove the caller and its lease to the station.

        Args:
            session: The browser's session.
        """
        token = self.token_of(session)
        headers = {} if token is None else {"Authorization": f"Bearer {token}"}
        lease = self.lease_of(session)
        return headers if lease is None else {**headers, LEASE_HEADER: lease}

    def client_of(self, session: BrowserSession) -> AsyncStationClient:
        """Return a client that acts for a session; the caller closes it."""
        client = AsyncStationClient(
            self.url, _NO_TOKEN, timeout=_REQUEST_TIMEOUT, ca=self._ca
        )
        client.begin_within(self.deadline)
        self.renew(client, session)
        return client

    def acting_for(self, session: BrowserSession) -> AsyncStationClient:
        """Return a client, shared by all, that acts for a session in its next request.

        Use it for requests that pages send every second, because opening a client takes
        20 ms of CPU.

        Args:
            session: The session that acts. The request has to begin before anything
                else is awaited, or it may act for another session.
        """
        if self._shared is None:
            self._shared = self.client_of(session)
        self.renew(self._shared, session)
        return self._shared

    def renew(self, client: AsyncStationClient, session: BrowserSession) -> str | None:
        """Let a client of `client_of` act with the present credentials of its session.

        Args:
            client: The client.
            session: The session that it acts for.

        Returns:
            The lease; None without one.
        """
        lease = self.lease_of(session)
        client.talk_to(self.url, self.token_of(session))
        client.lease.act_under(lease)
        return lease

    def role_at_viser(self, session: BrowserSession) -> Role:
        """Return the role of a session at Viser's panel, which all browsers share.

        The panel acts under the lease of the session that holds control. All other
        sessions may then only watch, so that no second person uses that lease.
        """
        lease = self._present()
        is_others = lease is not None and lease.session is not session
        return Role.VIEWER if is_others else session.role

    def note(
        self,
        session: BrowserSession,
        state: ControlState,
        key: str | None,
        asked_at: float,
    ) -> None:
        """Note the station's answer to a session about control.

        Args:
            session: The session that asked.
            state: The answer.
            key: The lease that the request named; None without one.
            asked_at: Monotonic time before the request [s]; the lease lasts from then.
        """
        if state.mine and state.lease is not None and state.expires_in is not None:
            before = self._lease
            # Sessions may share a token; the lease stays with the one that took it.
            if before is not None and before.key == state.lease:
                session = before.session
            self._set(_Lease(session, state.lease, asked_at + state.expires_in))
        else:
            self.lose(key)

    def lose(self, key: str | None) -> None:
        """Forget a lease that has ended; a newer lease stays.

        Args:
            key: The lease; None changes nothing.
        """
        if self._lease is not None and self._lease.key == key:
            self._set(None)

    def _present(self) -> _Lease | None:
        """Return the lease until its deadline; then another client may have control."""
        lease = self._lease
        return lease if lease is not None and self._now() < lease.deadline else None

    def _set(self, lease: _Lease | None) -> None:
        before, self._lease = self._lease, lease
        key = None if lease is None else lease.key
        if key != (None if before is None else before.key):
            self._lease_changed(key)


class SessionPusher:
    """Pushes arms and moves objects for sessions, in Viser's event loop only.

    Args:
        access: The credentials of the sessions.
        sessions: The logged-in browsers.
    """

    def __init__(self, access: SessionAccess, sessions: Sessions) -> None:
        self._access = access
        self._sessions = sessions
        self._client: AsyncStationClient | None = None

    async def __call__(self, key: str, arm_id: str, push: ExternalForce) -> None:
        """Push a link.

        Args:
            key: Key of the session that pushes.
            arm_id: The arm.
            push: The force, and for how long.

        Raises:
            ApiError: The session has ended or only watches, or the station refuses.
        """
        client = self._acting(key)
        await client.robot(arm_id).apply_force(push)

    async def move(self, key: str, name: str, position: list[float]) -> None:
        """Move an object of the scene.

        Args:
            key: Key of the session that moves it.
            name: The object.
            position: Target position [m].

        Raises:
            ApiError: The session has ended or only watches, or the station refuses.
        """
        await self._acting(key).put_object(name, position=[*position])

    def _acting(self, key: str) -> AsyncStationClient:
        """Return the client that acts for a session.

        Raises:
            ApiError: The session has ended or only watches.
        """
        session = self._sessions.named(key)
        if session is None or session.role is not Role.OPERATOR:
            raise ApiError(
                "Only a logged-in operator pushes robots and moves objects.",
                status=403,
                code="forbidden",
                remedy="Log in as operator.",
            )
        if self._client is None:
            self._client = self._access.client_of(session)
        # A client of its own: that of `acting_for` belongs to another event loop.
        self._access.renew(self._client, session)
        return self._client

    async def close(self) -> None:
        """Close the connection."""
        if self._client is not None:
            await self._client.close()
