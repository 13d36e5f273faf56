# Generated from _async/control_lease.py by tools/generate_client.py.
"""The lease of control: taken, kept by heartbeats in the background, given back."""

from types import TracebackType
from typing import Self

from station import wire
from station.client._sync.connection import Connection
from station.client.errors import ApiError
from station.client.heartbeat import Heartbeat

_PATH = "/control"
_LOST = frozenset({"control_held", "control_not_held"})
BEATS = 3.0
"""So many heartbeats are sent while one would do."""


class ControlLease:
    """Control of the station for the length of a `with` block.

    While it lasts, changes by other operators are refused. Heartbeats are sent in the
    background; when somebody takes control by force, or no heartbeat came through for
    `ttl`, the requests of this client are refused with the new owner's name.

    Args:
        connection: The client's connection.
        owner: Name that others are told; that of the token when None.
        ttl: How long the lease lasts when this program falls silent [s], 0.5 to 3600.
        force: Take control from whoever holds it.
    """

    def __init__(
        self,
        connection: Connection,
        owner: str | None,
        ttl: float,
        *,
        force: bool,
    ) -> None:
        self._connection = connection
        self._request = wire.ControlRequest(owner=owner, ttl=ttl, force=force)
        self._heartbeat = Heartbeat(self.renew, ttl / BEATS)

    @property
    def lost(self) -> ApiError | None:
        """Why control was lost: an error with the new owner's name; None if it is not.

        A loss is noticed at the next heartbeat, within a third of `ttl`.
        """
        return self._heartbeat.refusal

    def __enter__(self) -> Self:
        """Take control.

        Raises:
            ApiError: Somebody else holds control.
            StationUnreachableError: The station does not answer.
        """
        state = self._connection.send("POST", _PATH, wire.ControlState, self._request)
        self._connection.lease = state.lease
        self._heartbeat.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._heartbeat.stop()
        try:
            self._connection.send("DELETE", _PATH, wire.ControlState)
        except ApiError as refused:
            if refused.code not in _LOST:
                raise
        finally:
            self._connection.lease = None

    def renew(self) -> wire.ControlState:
        """Send a heartbeat now."""
        request = wire.ControlPatch(ttl=self._request.ttl)
        return self._connection.send("PATCH", _PATH, wire.ControlState, request)

    def hand_over(self, to: str) -> wire.ControlState:
        """Let somebody take control without force.

        Args:
            to: The owner that they take it as, or the name of their token.
        """
        request = wire.ControlPatch(hand_over_to=to)
        return self._connection.send("PATCH", _PATH, wire.ControlState, request)
