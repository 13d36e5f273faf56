"""Serve WebSocket clients: first hello, then frames as fast as each client reads."""

import asyncio
import logging
from collections.abc import Coroutine, Sequence

import anyio.to_thread
from starlette.websockets import WebSocket, WebSocketDisconnect

from station import wire
from station.api import answers
from station.api.auth import Access, Role
from station.api.streams.channel import (
    Channel,
    Frame,
    StreamClient,
    StreamPort,
    encode,
    open_channel,
)
from station.api.streams.cycle_samples import Data, Payload
from station.api.streams.request import StreamRequest
from station.api.streams.topics import Topic
from station.core.errors import StationError
from station.core.facade.station import Station

CLOSE_INTERNAL_ERROR = 1011
PORT = "station.port"
"""Key in the scope's state for the client's connection, a `StreamPort`."""

_log = logging.getLogger(__name__)


class Broadcaster:
    """All streams of a station. Use it in one event loop only.

    Args:
        station: Source of the data.
        slow_after: Time without reading after which a client is closed [s].
        max_clients: Most clients at the same time. Viewers together may have three
            quarters of them, and a browser's session a quarter, so that no viewer can
            keep operators out.
    """

    def __init__(
        self, station: Station, *, slow_after: float = 5.0, max_clients: int = 64
    ) -> None:
        self._station = station
        self._slow_after = slow_after
        self._max_clients = max_clients
        self._channels: dict[StreamRequest, Channel] = {}
        self._clients: dict[asyncio.Task[None], Access] = {}
        self._closing = asyncio.Event()

    @property
    def clients(self) -> int:
        """Number of connected clients."""
        return len(self._clients)

    async def close(self, timeout: float = 1.0) -> None:
        """Close all streams at the station's end, and wait briefly for the clients."""
        self._closing.set()
        if self._clients:
            await asyncio.wait(self._clients, timeout=timeout)

    async def serve(
        self,
        websocket: WebSocket,
        request: StreamRequest,
        topic: Topic,
        access: Access,
    ) -> None:
        """Send frames to an accepted client until either side or its session ends."""
        refused = self._refusal(access)
        if refused is not None:
            await websocket.close(wire.CLOSE_TRY_LATER, refused)
            return
        task = asyncio.create_task(self._serve(websocket, request, topic, access))
        self._clients[task] = access
        try:
            await task
        finally:
            self._clients.pop(task, None)
            task.cancel()

    def _refusal(self, access: Access) -> str | None:
        """Return the reason for refusing another stream; None if it is accepted."""
        present, most = self._clients.values(), self._max_clients
        if self._closing.is_set():
            return "the station shuts down"
        if len(present) >= most:
            return f"there are {most} streams already"
        # Viewers must leave a quarter free, so that an operator can always open a
        # stream.
        share = most - most // 4
        viewers = sum(one.role is Role.VIEWER for one in present)
        if access.role is Role.VIEWER and viewers >= share:
            return f"viewers have {share} streams already"
        # A page that opens more and more streams must not keep other clients out.
        share = max(1, most // 4)
        same = sum(one.session is access.session for one in present)
        if access.session is not None and same >= share:
            return f"this session has {share} streams already"
        return None

    async def _serve(
        self,
        websocket: WebSocket,
        request: StreamRequest,
        topic: Topic,
        access: Access,
    ) -> None:
        channel = self._channels.get(request)
        if channel is None:
            cycle_yield = self._station.loop.cycle_yield
            channel = open_channel(request, topic, cycle_yield)
            self._channels[request] = channel
        port: StreamPort = websocket.scope["state"][PORT]
        client = StreamClient(port, channel, self._slow_after)
        channel.join(client)
        try:
            code, reason = await self._first_end(websocket, channel, client, access)
        finally:
            channel.leave(client)
            if channel.clients == 0 and self._channels.get(request) is channel:
                del self._channels[request]
        if code:
            port.abort(code, reason)

    async def _first_end(
        self,
        websocket: WebSocket,
        channel: Channel,
        client: StreamClient,
        access: Access,
    ) -> tuple[int, str]:
        """Return the closing code and reason; (0, "") if the client has left."""
        ends: list[tuple[Coroutine[object, object, None], int, str]] = [
            (_drain(websocket), 0, ""),
            (self._feed(channel, client), wire.CLOSE_TOO_SLOW, "took no frame in time"),
            (self.wait_closing(), wire.CLOSE_GOING_AWAY, "the station shuts down"),
            (access.wait_for_end(), wire.CLOSE_UNAUTHORIZED, "the session has ended"),
        ]
        what = f"stream {channel.request}"
        return await first_end(ends, what)

    async def wait_closing(self) -> None:
        """Wait until all streams must end because the station shuts down."""
        await self._closing.wait()

    async def _feed(self, channel: Channel, client: StreamClient) -> None:
        """Send frames; return if the client reads none for too long."""
        seq = channel.beginning
        hello = await anyio.to_thread.run_sync(self._hello, channel.request, seq)
        await client.serve(hello)

    def _hello(self, request: StreamRequest, seq: int) -> Frame:
        station = self._station
        data: Data = {"joint_states": None, "controllers": [], "stop": {}}
        data["stop"] = answers.stop_state(station).model_dump()
        try:
            data.update(answers.controllers(station).model_dump())
            snapshot = station.latest()
            states = answers.joint_states(snapshot, station.joint_names)
            data["joint_states"] = states.model_dump()
        # A client may connect to a station whose loop has ended, to learn the reason.
        except StationError:
            _log.info("a client connects while the loop does not run")
        loop = station.loop
        payload = Payload(loop.cycle, station.epoch, loop.time, data)
        return encode(
            "hello",
            payload,
            seq=seq,
            format=request.format,
            boot_id=station.boot_id,
        )


async def first_end(
    ends: Sequence[tuple[Coroutine[object, object, None], int, str]], what: str
) -> tuple[int, str]:
    """Wait for the first of several ends of a connection, and cancel the others.

    Args:
        ends: For each end, a coroutine that returns when the connection must end, and
            the close code and reason.
        what: Name of the connection in the log, if a coroutine raises an error.

    Returns:
        Close code and reason; (0, "") if the client has already left.
    """
    tasks = [asyncio.create_task(end) for end, _, _ in ends]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        # Wait for the cancelled ones as well, so that they release what they hold
        # before the next step.
        outcomes = await asyncio.gather(*tasks, return_exceptions=True)
    for outcome, (_, code, reason) in zip(outcomes, ends, strict=True):
        if outcome is None:
            return code, reason
        if isinstance(outcome, WebSocketDisconnect):
            return 0, ""
        if not isinstance(outcome, asyncio.CancelledError):
            _log.error("%s failed", what, exc_info=outcome)
            return CLOSE_INTERNAL_ERROR, "the stream failed; see the station's log"
    return 0, ""


async def _drain(websocket: WebSocket) -> None:
    """Read and drop the client's messages; return when the client has left."""
    while True:
        message = await websocket.receive()
        if message["type"] == "websocket.disconnect":
            return
