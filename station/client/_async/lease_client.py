"""Control of the station, call by call; `control` of the client does it for a block."""

from station import wire
from station.client._async.connection import AsyncConnection


class AsyncLeaseClient:
    """Control of the station, taken and given back call by call: `client.lease`.

    `AsyncStationClient.control` does this for the length of a `with` block, with
    heartbeats; here the caller sends them.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    def act_under(self, lease: str | None) -> None:
        """Let the requests from now on act under a lease of control.

        Args:
            lease: The `lease` that whoever took control was told; None for none.
        """
        self._connection.lease = lease

    async def take(
        self, owner: str | None = None, *, ttl: float = 10.0, force: bool = False
    ) -> wire.ControlState:
        """Take control, for clients that then `act_under` the `lease` of the answer.

        Args:
            owner: Name that others are told; that of the token when None.
            ttl: How long control lasts without `renew` [s], 0.5 to 3600.
            force: Take control from whoever holds it.
        """
        request = wire.ControlRequest(owner=owner, ttl=ttl, force=force)
        return await self._connection.send(
            "POST", "/control", wire.ControlState, request
        )

    async def renew(self, *, hand_over_to: str | None = None) -> wire.ControlState:
        """Keep control, which this client, or its named token, holds.

        Args:
            hand_over_to: Owner or token that may take control without force; as before
                when None.
        """
        request = wire.ControlPatch(hand_over_to=hand_over_to)
        return await self._connection.send(
            "PATCH", "/control", wire.ControlState, request
        )

    async def release(self) -> wire.ControlState:
        """Give control back, which this client, or its named token, holds."""
        return await self._connection.send("DELETE", "/control", wire.ControlState)

    async def state(self) -> wire.ControlState:
        """Return who holds control."""
        # Unlike `get`, this names the lease: the station says whose it is.
        return await self._connection.send("GET", "/control", wire.ControlState)
