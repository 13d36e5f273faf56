"""Named tokens of a station."""

from station import wire
from station.client._async.connection import AsyncConnection
from station.client.routes import segment


class AsyncTokensClient:
    """Named tokens, made, listed and revoked by an operator: `client.tokens`.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def list(self) -> list[wire.Token]:
        """Return the named tokens that are valid."""
        return (await self._connection.get("/tokens", wire.Tokens)).tokens

    async def create(
        self,
        name: str,
        role: wire.RoleName = "operator",
        *,
        expires: float | None = None,
    ) -> wire.NewToken:
        """Make a token; the answer alone has it.

        Args:
            name: Whose token it is.
            role: `operator` or `viewer`.
            expires: How long it is valid [s]; None until it is revoked.
        """
        request = wire.TokenRequest(name=name, role=role, expires=expires)
        return await self._connection.send("POST", "/tokens", wire.NewToken, request)

    async def revoke(self, name: str) -> wire.Token:
        """End a token, and the streams, sessions and the control it has."""
        path = f"/tokens/{segment(name)}"
        return await self._connection.send("DELETE", path, wire.Token)
