"""The tool port for Foxglove: live channels, gains as parameters, switches."""

import asyncio
from collections.abc import Iterable
from typing import ClassVar

from fastapi import FastAPI
from starlette.websockets import WebSocketDisconnect
from typing_extensions import override

from station.api.foxglove.foxglove_session import (
    SUBPROTOCOLS,
    FoxgloveChanges,
    FoxgloveSession,
    StationFaultError,
)
from station.api.foxglove.live_channels import LiveChannels
from station.api.tool_port import Place, ToolClient, ToolPort

_PARAMETERS_EVERY = 25
"""Ticks between two checks whether gains have changed."""


class FoxglovePort(ToolPort[FoxgloveSession]):
    """The application at the tool port that speaks Foxglove's protocol.

    Args:
        app: The application of the API, whose station, tokens and lease it shares.
        channels: Channels that a client can subscribe to.
        place: Address of the port, and the clients that it admits.
    """

    tool: ClassVar[str] = "Foxglove"
    subprotocols: ClassVar[tuple[str, ...]] = SUBPROTOCOLS
    rate: ClassVar[float] = 50.0
    most_clients: ClassVar[int] = 16

    def __init__(self, app: FastAPI, channels: LiveChannels, place: Place) -> None:
        super().__init__(app, place)
        self._channels = channels
        self._numbers: dict[str, int] = {}
        self._ticks = 0

    @override
    def open(self, client: ToolClient) -> FoxgloveSession:
        changes = FoxgloveChanges(client)
        session = FoxgloveSession(
            client.websocket, self._channels, changes, self._numbers
        )
        self._channels.newest(())  # makes the channels known, to advertise them
        return session

    @override
    async def tick(self) -> None:
        wanted = {topic for session in self.sessions for topic in session.topics}
        messages = self._channels.newest(wanted)
        for session in self.sessions:
            session.offer(messages)
        self._ticks += 1
        if self._ticks % _PARAMETERS_EVERY == 0:
            await self._watch_parameters(tuple(self.sessions))

    async def _watch_parameters(self, sessions: Iterable[FoxgloveSession]) -> None:
        for session in sessions:
            try:
                async with asyncio.timeout(1.0):
                    await session.watch_parameters()
            except (TimeoutError, WebSocketDisconnect, RuntimeError):
                continue  # slow or disconnected; its own task ends it
            except StationFaultError:
                continue  # logged where it was raised
