"""Frames for clients with equal requests: made once, and taken by each client.

Nothing is queued. A late client gets the newest frame; if it wants every cycle, it gets
a larger batch from the ring of cycles.
"""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple, Protocol

import msgspec.msgpack
import orjson
from typing_extensions import override
from websockets.frames import Frame as WebSocketFrame, Opcode

from station.api.streams.cycle_samples import Data, Payload
from station.api.streams.request import StreamRequest
from station.api.streams.topics import EventsTopic, Topic
from station.core.loop.cycle_yield import CycleYield
from station.events import Event
from station.wire import StreamFormat

_msgpack = msgspec.msgpack.Encoder()
BATCH_PERIOD = 0.02
"""Time between two batches for clients that want every cycle [s]."""
HEARTBEAT = 1.0
"""Time after which an unchanged state is sent again [s]."""


class Frame(NamedTuple):
    """An encoded message.

    Attributes:
        seq: Its number in its stream.
        message: The message, JSON or msgpack.
        wire: The message in its WebSocket frame. A server does not mask frames, so all
            clients get the same bytes.
    """

    seq: int
    message: bytes
    wire: bytes


def encode(
    topic: str,
    payload: Payload,
    *,
    seq: int,
    format: StreamFormat,  # noqa: A002 - the word in the URL
    fields: frozenset[str] = frozenset(),
    boot_id: str = "",
) -> Frame:
    """Encode a frame.

    Args:
        topic: Name of the topic, or `hello`.
        payload: Content; numbers that are not finite become null in JSON.
        seq: Its number in its stream.
        format: Encoding of the frame.
        fields: Keys to send of the data, or of each sample in a batch; empty sends all.
            A batch keeps its other keys.
        boot_id: Identifier of the station's run; left out if empty.
    """
    message: Data = {
        "topic": topic,
        "seq": seq,
        "epoch": payload.epoch,
        "cycle": payload.cycle,
        "stamp": payload.stamp,
        "data": _selected(payload.data, fields) if fields else payload.data,
    }
    if boot_id:
        message["boot_id"] = boot_id
    if format == "json":
        return _frame(seq, Opcode.TEXT, orjson.dumps(message))
    return _frame(seq, Opcode.BINARY, _msgpack.encode(message))


def _frame(seq: int, opcode: Opcode, message: bytes) -> Frame:
    wire = WebSocketFrame(opcode, message).serialize(mask=False)
    return Frame(seq, message, wire)


def _selected(data: Data, fields: frozenset[str]) -> Data:
    samples = data.get("samples")
    if not isinstance(samples, list):
        return {key: value for key, value in data.items() if key in fields}
    kept = fields | {"cycle"}
    chosen = [{key: s[key] for key in s if key in kept} for s in samples]
    batch: Data = {**data, "samples": chosen}
    for head in ("name", "arm_id"):
        if head not in fields:
            batch.pop(head, None)
    return batch


class ChannelClient(Protocol):
    """A client that takes the frames of a channel."""

    def ticked(self) -> None:
        """Take the waiting frames; called after every tick."""

    def failed(self, error: BaseException) -> None:
        """End, because no more frames will come."""


class Channel(ABC):
    """Makes frames at a rate for its clients. Use it in one event loop only.

    Args:
        request: The request, which is the same for all its clients.
        cycle_yield: Tells when to wait for the control thread.
        period: Time between two ticks [s].
    """

    def __init__(
        self, request: StreamRequest, cycle_yield: CycleYield, period: float
    ) -> None:
        self.request = request
        self._cycle_yield = cycle_yield
        self._period = period
        self._clients: dict[ChannelClient, None] = {}
        self._task: asyncio.Task[None] | None = None
        self._failure: BaseException | None = None

    @property
    def clients(self) -> int:
        """Number of clients that take its frames; it ticks while it has clients."""
        return len(self._clients)

    @property
    @abstractmethod
    def newest(self) -> int:
        """Number of the newest frame, or of the newest cycle."""

    @property
    @abstractmethod
    def beginning(self) -> int:
        """Number of the frame after which a new client begins."""

    @abstractmethod
    def take(self, after: int) -> Frame | None:
        """Return the next frame for a client; None if there is none yet.

        Args:
            after: Number of the last frame that the client has.
        """

    @abstractmethod
    async def tick(self) -> None:
        """Make the frames of this tick."""

    def join(self, client: ChannelClient) -> None:
        """Call `client` at every tick from now on."""
        self._clients[client] = None
        if self._failure is not None:
            client.failed(self._failure)
        elif self._task is None:
            self.begin()
            self._task = asyncio.create_task(self._run())

    def leave(self, client: ChannelClient) -> None:
        """Stop calling `client`."""
        self._clients.pop(client, None)
        if not self._clients and self._task is not None:
            self._task.cancel()
            self._task = None
            self.end()

    def begin(self) -> None:
        """Prepare for the first client; the default does nothing."""
        return

    def end(self) -> None:
        """Undo `begin` after the last client has left."""
        return

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        deadline = loop.time()
        try:
            while True:
                await self.tick()
                for client in tuple(self._clients):
                    self._cycle_yield.wait_if_cycle_is_due()
                    client.ticked()
                # A late tick is not repeated, because clients take only the newest
                # frame.
                deadline = max(deadline + self._period, loop.time())
                await asyncio.sleep(deadline - loop.time())
        except Exception as error:  # noqa: BLE001 - every client gets it
            self._failure = error
            for client in tuple(self._clients):
                client.failed(error)


class StateChannel(Channel):
    """The newest state at a rate.

    Args:
        request: The request, which is the same for all its clients.
        cycle_yield: Tells when to wait for the control thread.
        topic: Source of the state.
        rate: Frames per second [Hz].
    """

    def __init__(
        self,
        request: StreamRequest,
        cycle_yield: CycleYield,
        topic: Topic,
        rate: float,
    ) -> None:
        super().__init__(request, cycle_yield, 1.0 / rate)
        self._topic = topic
        self._frame = Frame(0, b"", b"")
        self._cycle = 0
        self._made_at = 0.0

    @property
    @override
    def newest(self) -> int:
        return self._frame.seq

    @property
    @override
    def beginning(self) -> int:
        # Begin one frame before the newest, so that a new client gets the present state
        # without waiting.
        return max(0, self._frame.seq - 1)

    @override
    def take(self, after: int) -> Frame | None:
        return self._frame if self._frame.seq > after else None

    @override
    async def tick(self) -> None:
        payload = await self._topic.latest()
        now = asyncio.get_running_loop().time()
        if payload is None:
            return
        # A paused station makes no cycles; repeating the state shows that the link
        # works.
        if payload.cycle == self._cycle and now - self._made_at < HEARTBEAT:
            return
        self._cycle = payload.cycle
        self._made_at = now
        self._cycle_yield.wait_if_cycle_is_due()
        self._frame = encode(
            self._topic.name,
            payload,
            seq=self._frame.seq + 1,
            format=self.request.format,
            fields=self.request.fields,
        )


class FullChannel(Channel):
    """Every cycle, in batches; a frame has the number of its last cycle.

    Args:
        request: The request, which is the same for all its clients.
        cycle_yield: Tells when to wait for the control thread.
        topic: Source of the samples.
    """

    def __init__(
        self, request: StreamRequest, cycle_yield: CycleYield, topic: Topic
    ) -> None:
        super().__init__(request, cycle_yield, BATCH_PERIOD)
        self._topic = topic
        self._samples = topic.every_cycle()
        self._newest = self._samples.newest_cycle()
        self._batches: dict[int, Frame] = {}

    @property
    @override
    def newest(self) -> int:
        return self._newest

    @property
    @override
    def beginning(self) -> int:
        return self._newest

    @override
    def begin(self) -> None:
        self._samples.open()
        self._newest = self._samples.newest_cycle()

    @override
    def end(self) -> None:
        self._samples.close()

    @override
    def take(self, after: int) -> Frame | None:
        if after >= self._newest:
            return None
        return self._batches.get(after) or self._batch(after)

    @override
    async def tick(self) -> None:
        self._newest = self._samples.newest_cycle()
        self._batches.clear()

    def _batch(self, after: int) -> Frame | None:
        # All clients that keep up get the same batch until the next tick.
        payload = self._samples.since(after, self._newest)
        if payload is None:
            return None
        frame = encode(
            self._topic.name,
            payload,
            seq=payload.cycle,
            format=self.request.format,
            fields=self.request.fields,
        )
        self._batches[after] = frame
        return frame


class FramesLostError(Exception):
    """A client is so late that frames which it must not miss no longer exist."""


class EventChannel(Channel):
    """Every event, one per frame; a frame has the number of its event.

    Args:
        request: The request, which is the same for all its clients.
        cycle_yield: Tells when to wait for the control thread.
        topic: Source of the events.
        rate: Rate at which it looks for new events [Hz].
    """

    def __init__(
        self,
        request: StreamRequest,
        cycle_yield: CycleYield,
        topic: EventsTopic,
        rate: float,
    ) -> None:
        super().__init__(request, cycle_yield, 1.0 / rate)
        self._topic = topic
        self._newest = topic.log.newest_id
        self._frames: dict[int, Frame] = {}

    @property
    @override
    def newest(self) -> int:
        return self._newest

    @property
    @override
    def beginning(self) -> int:
        return self._topic.log.newest_id

    @override
    def take(self, after: int) -> Frame | None:
        """Return the frame of the next event.

        Raises:
            FramesLostError: The event log no longer has the next event in memory.
        """
        if after >= self._newest:
            return None
        frame = self._frames.get(after + 1)
        if frame is not None:
            return frame
        # No event may be left out silently: the client must read the missed ones
        # itself.
        if not self._topic.log.is_in_memory(after):
            raise FramesLostError
        found = self._topic.log.recent(after)
        return self._frame(found[0]) if found else None

    @override
    async def tick(self) -> None:
        # Clients that keep up need only the frames of events since the last tick.
        self._frames.clear()
        log, before = self._topic.log, self._newest
        if log.newest_id > before:
            for event in log.recent(before):
                self._frame(event)
                self._newest = event.id

    def _frame(self, event: Event) -> Frame:
        frame = encode(
            self._topic.name,
            self._topic.payload(event),
            seq=event.id,
            format=self.request.format,
            fields=self.request.fields,
        )
        self._frames[event.id] = frame
        return frame


def open_channel(
    request: StreamRequest, topic: Topic, cycle_yield: CycleYield
) -> Channel:
    """Return the channel that a request needs."""
    if isinstance(topic, EventsTopic):
        rate = request.rate or topic.default_rate
        return EventChannel(request, cycle_yield, topic, rate)
    if request.rate is not None:
        return StateChannel(request, cycle_yield, topic, request.rate)
    return FullChannel(request, cycle_yield, topic)


class StreamPort(Protocol):
    """The connection of a client, written to without a task or queue in between."""

    def write_frame(self, wire: bytes) -> None:
        """Write a whole WebSocket frame to the connection."""

    def is_writable(self) -> bool:
        """Return whether the connection accepts more bytes."""

    def listen(self, resumed: Callable[[], None] | None) -> None:
        """Call `resumed` whenever the connection accepts bytes again; None ends it."""

    def abort(self, code: int, reason: str) -> None:
        """Close with a code, even if the client does not read."""


class StreamClient:
    """Writes the frames of a channel to a connection. Use it in one event loop only.

    A client whose connection is full misses frames; if it wants every cycle, it gets
    larger batches later.

    Args:
        port: The client's connection.
        channel: Source of the frames.
        slow_after: Longest time for which the connection may be full [s].
    """

    def __init__(self, port: StreamPort, channel: Channel, slow_after: float) -> None:
        self._port = port
        self._channel = channel
        self._slow_after = slow_after
        self._loop = asyncio.get_running_loop()
        self._seq: int | None = None
        self._blocked: asyncio.TimerHandle | None = None
        self._end: asyncio.Future[None] = self._loop.create_future()

    async def serve(self, hello: Frame) -> None:
        """Send `hello`, then frames; return if the client reads none for too long.

        The client must have joined the channel before, so that the channel samples.

        Args:
            hello: The first frame; further frames come after its number.

        Raises:
            RuntimeError: The channel has failed; the cause has the reason.
        """
        self._port.listen(self._resumed)
        try:
            self._write(hello)
            self.ticked()
            await self._end
        finally:
            self._port.listen(None)
            self._unblock()

    def ticked(self) -> None:
        """Write the next frame, if there is one and the connection is ready."""
        if self._seq is None or self._blocked is not None or self._end.done():
            return
        try:
            frame = self._channel.take(self._seq)
        except FramesLostError:
            self._too_slow()
            return
        if frame is None:
            return
        self._write(frame)
        if self._blocked is None and frame.seq < self._channel.newest:
            # Go on with missed batches later, so that other clients get their turn in
            # between.
            self._loop.call_soon(self.ticked)

    def failed(self, error: BaseException) -> None:
        """End with the error of the channel."""
        if not self._end.done():
            broken = RuntimeError(f"{self._channel.request.topic} broke down")
            broken.__cause__ = error
            self._end.set_exception(broken)

    def _write(self, frame: Frame) -> None:
        self._seq = frame.seq
        self._port.write_frame(frame.wire)
        if not self._port.is_writable():
            self._blocked = self._loop.call_later(self._slow_after, self._too_slow)

    def _resumed(self) -> None:
        self._unblock()
        self.ticked()

    def _unblock(self) -> None:
        if self._blocked is not None:
            self._blocked.cancel()
            self._blocked = None

    def _too_slow(self) -> None:
        if not self._end.done():
            self._end.set_result(None)
