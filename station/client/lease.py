"""Control of the station: for a block with heartbeats, or call by call."""

from typing import TYPE_CHECKING, Self

from station import wire
from station.client.connection import AsyncConnection, ClientPart
from station.client.errors import ApiError, StationUnreachableError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

_LOST = frozenset({"control_held", "control_not_held"})
BEATS = 3.0
"""So many heartbeats are sent while one would do."""


class AsyncLeaseClient(ClientPart):
    """Control of the station, taken and given back call by call: `client.lease`.

    `AsyncStationClient.control` does this for the length of a `with` block, with
    heartbeats; here the caller sends them.
    """

    _path = "/control"

    def act_under(self, lease: str | None) -> None:
        """Let the requests from now on act under a lease of control.

        Args:
            lease: The `lease` in the answer to taking control; None for none.
        """
        self._connection.lease = lease

    async def take(
        self, owner: str | None = None, *, ttl: float = 10.0, force: bool = False
    ) -> wire.ControlState:
        """Take control, for clients that then `act_under` the `lease` of the answer.

        Args:
            owner: Name that others see; that of the token when None.
            ttl: How long control lasts without `renew` [s], 0.5 to 3600.
            force: Take control from its holder.
        """
        request = wire.ControlRequest(owner=owner, ttl=ttl, force=force)
        return await self._send("POST", self._path, wire.ControlState, request)

    async def renew(self, *, hand_over_to: str | None = None) -> wire.ControlState:
        """Keep control, which this client, or its named token, holds.

        Args:
            hand_over_to: Owner or token that may take control without force; as before
                when None.
        """
        request = wire.ControlPatch(hand_over_to=hand_over_to)
        return await self._send("PATCH", self._path, wire.ControlState, request)

    async def release(self) -> wire.ControlState:
        """Give control back, which this client, or its named token, holds."""
        return await self._send("DELETE", self._path, wire.ControlState)

    async def state(self) -> wire.ControlState:
        """Return the present holder of control."""
        # Unlike `get`, this names the lease: the station says whose it is.
        return await self._send("GET", self._path, wire.ControlState)


class AsyncControlLease:
    """Control of the station for the length of a `with` block.

    While it lasts, changes by other operators are refused. Heartbeats are sent in the
    background; when a client takes control by force, or no heartbeat came through for
    `ttl`, the requests of this client are refused with the new owner's name.

    Args:
        connection: The client's connection.
        owner: Name that others see; that of the token when None.
        ttl: How long the lease lasts when this program falls silent [s], 0.5 to 3600.
        force: Take control from its holder.

    Attributes:
        lost: Why control was lost: an error with the new owner's name; None if it is
            not. A loss is noticed at the next heartbeat, within a third of `ttl`.
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
            return True  # the link may come back before the lease is over
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
            to: The owner that they take it as, or the name of their token.
        """
        return await self._control.renew(hand_over_to=to)
