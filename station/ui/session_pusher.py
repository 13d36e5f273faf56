"""Push simulated arms for sessions whose people pull at them in the 3D view."""

from station.client import ApiError, AsyncStationClient
from station.ui.session_access import SessionAccess
from station.ui.sessions import Role, Sessions
from station.wire import ExternalForce


class SessionPusher:
    """Pushes with what each session has at the station. In Viser's event loop only.

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
        session = self._sessions.named(key)
        if session is None or session.role is not Role.OPERATOR:
            raise ApiError(
                "Only a logged-in operator pushes.",
                status=403,
                code="forbidden",
                remedy="Log in as operator.",
            )
        if self._client is None:
            self._client = self._access.client_of(session)
        # A client of its own: that of `acting_for` belongs to another event loop.
        self._access.renew(self._client, session)
        await self._client.robot(arm_id).apply_force(push)

    async def close(self) -> None:
        """Close the connection."""
        if self._client is not None:
            await self._client.close()
