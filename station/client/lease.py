"""Control of the station: for a `with` block with heartbeats, or call by call."""

from typing import TYPE_CHECKING, Self

from station import wire
from station.client.connection import AsyncConnection, ClientPart
from station.client.errors import ApiError, StationUnreachableError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

_LOST = frozenset({"control_held", "control_not_held"})
BEATS = 3.0
"""Heartbeats per `ttl`, where one would be enough."""


class AsyncLeaseClient(ClientPart):
    """Control of the station, taken and given back call by call: `client.lease`.

    Here the caller sends the heartbeats; `AsyncStationClient.control` sends them in the
    background, for the duration of a `with` block.
    """

    _path = "/control"

    def act_under(self, lease: str | None) -> None:
        """Send requests under a lease of control from now on.

        Args:
            lease: The `lease` in the answer of `take`; None for no lease.
        """
        self._connection.lease = lease

    async def take(
        self, owner: str | None = None, *, ttl: float = 10.0, force: bool = False
    ) -> wire.ControlState:
        """Take control; call `act_under` with the `lease` of the answer.

        Args:
            owner: Name that others see; None for the name of the token.
            ttl: How long control lasts without `renew` [s], 0.5 to 3600.
            force: Whether to take control from its present holder.
        """
        request = wire.ControlRequest(owner=owner, ttl=ttl, force=force)
        return await self._send("POST", self._path, wire.ControlState, request)

    async def renew(self, *, hand_over_to: str | None = None) -> wire.ControlState:
        """Renew control, which this client or its named token must hold.

        Args:
            hand_over_to: Owner or token that may take control without force; None keeps
                the offer.
        """
        request = wire.ControlPatch(hand_over_to=hand_over_to)
        return await self._send("PATCH", self._path, wire.ControlState, request)

    async def release(self) -> wire.ControlState:
        """Give control back, which this client or its named token must hold."""
        return await self._send("DELETE", self._path, wire.ControlState)

    async def state(self) -> wire.ControlState:
        """Return the present holder of control."""
        # Unlike `get`, this sends the lease, so that the station can tell whether it is
        # ours.
        return await self._send("GET", self._path, wire.ControlState)


class AsyncControlLease:
    """Control of the station for the duration of a `with` block.

    While the block lasts, the station refuses changes by other operators. The client
    sends heartbeats in the background. After another client has taken control by force,
    or no heartbeat has arrived for `ttl`, the station refuses this client's requests
    with the new owner's name.

    Args:
        connection: The client's connection.
        owner: Name that others see; None for the name of the token.
        ttl: How long the lease lasts without a heartbeat [s], 0.5 to 3600.
        force: Whether to take control from its present holder.

    Attributes:
        lost: Error with the new owner's name after a loss of control; None before. The
            next heartbeat notices a loss, within a third of `ttl`.
    """

    def __init__(
        self,
        connection: AsyncConnection,
        owner: str | None,
        ttl: float,
        *,
        force: bool,
    ) -> None:
        self._connection = connection
        self._control = AsyncLeaseClient(connection)
        self._owner, self._ttl, self._force = owner, ttl, force
        self._stop_beating: Callable[[], Awaitable[None]] | None = None
        self.lost: ApiError | None = None

    async def __aenter__(self) -> Self:
        """Take control.

        Raises:
            ApiError: Another client holds control.
            StationUnreachableError: The station does not answer.
        """
        state = await self._control.take(self._owner, ttl=self._ttl, force=self._force)
        self._control.act_under(state.lease)
        self._stop_beating = self._connection.repeat(self._beat, self._ttl / BEATS)
        return self

    async def __aexit__(self, *_: object) -> None:
        if self._stop_beating is not None:
            await self._stop_beating()
        try:
            await self._control.release()
        except ApiError as refused:
            if refused.code not in _LOST:
                raise
        finally:
            self._control.act_under(None)

    async def _beat(self) -> bool:
        """Send a heartbeat; return whether to go on."""
        try:
            await self.renew()
        except StationUnreachableError:
            return True  # the link may recover before the lease ends
        except ApiError as error:
            self.lost = error
            return False
        return True

    async def renew(self) -> wire.ControlState:
        """Send a heartbeat now."""
        return await self._connection.send(
            "PATCH", "/control", wire.ControlState, wire.ControlPatch(ttl=self._ttl)
        )

    async def hand_over(self, to: str) -> wire.ControlState:
        """Let another client take control without force.

        Args:
            to: Name of the next owner, or of the next owner's token.
        """
        return await self._control.renew(hand_over_to=to)
