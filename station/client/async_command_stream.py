"""A stream of set-points for asyncio."""

import asyncio
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Self

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

from station.client.command_options import CommandOptions, written
from station.client.errors import StationUnreachableError
from station.client.stream_options import refusal
from station.wire import CommandCounts

if TYPE_CHECKING:
    from websockets.asyncio.connection import Connection


class AsyncCommandStream:
    """Sends set-points one after the other; the newest wins. Use it in `async with`.

    When the program sends nothing for `timeout`, the last set-point expires and the
    controller does what its `command_timeout` parameters say, as after a lost link.

    Args:
        options: Where the set-points go.

    Attributes:
        counts: What the station said last about the set-points it has received; None
            before the first report. Read while sending.
    """

    def __init__(self, options: CommandOptions) -> None:
        self.options = options
        self.counts: CommandCounts | None = None
        self._connection: Connection | None = None

    async def __aenter__(self) -> Self:
        """Connect.

        Raises:
            ApiError: The station refuses the stream.
            StationUnreachableError: The station does not answer.
        """
        options = self.options
        try:
            self._connection = await connect(
                options.url(),
                additional_headers=options.headers(),
                compression=None,
                proxy=None,
                ssl=options.tls,
                open_timeout=options.patience,
                close_timeout=1.0,
            )
        except (OSError, WebSocketException) as error:
            raise refusal(error) or StationUnreachableError(
                options.base_url, error
            ) from error
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """End the stream; the last set-point expires after its timeout."""
        connection, self._connection = self._connection, None
        if connection is not None:
            await connection.close()

    async def send(
        self,
        values: Sequence[float],
        *,
        epoch: int | None = None,
        rates: Sequence[float] | None = None,
    ) -> None:
        """Send a set-point; does not wait for the station.

        Args:
            values: One number per element of the controller, in its order and units.
            epoch: Refuse when a stop or reset came since that epoch.
            rates: How fast the set-point changes [rad/s or m/s].

        Raises:
            ApiError: The station has ended the stream, e.g. because control was lost.
            StationUnreachableError: The link broke, or there is no link.
            ValueError: A number is not finite.
        """
        connection = self._connection
        message = written(values, epoch, rates)
        if connection is None:
            closed = ConnectionError("The stream is not open; it opens in a `with`.")
            raise StationUnreachableError(self.options.base_url, closed)
        try:
            await self._read(connection)
            await connection.send(message)
        except (OSError, WebSocketException) as error:
            raise refusal(error) or StationUnreachableError(
                self.options.base_url, error
            ) from error

    async def _read(self, connection: "Connection") -> None:
        """Read the reports that have come."""
        while True:
            try:
                async with asyncio.timeout(0):
                    message = await connection.recv()
            except TimeoutError:
                return
            self.counts = CommandCounts.model_validate_json(message)
