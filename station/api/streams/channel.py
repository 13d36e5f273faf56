"""Frames that several clients asked for alike: made once, fetched by each client.

Nothing is queued. A client that comes late gets the newest frame, or with every cycle
asked for, a larger batch from the ring of snapshots.
"""

import asyncio
from abc import ABC, abstractmethod

from typing_extensions import override

from station.api.streams.frames import Frame, encode
from station.api.streams.request import StreamRequest
from station.api.streams.topics import CycleTopic, Topic

BATCH_PERIOD = 0.02
"""How often clients of every cycle get a batch [s]."""
BATCH_LIMIT = 250
"""Most cycles in one batch: encoding it must not hold the interpreter for long."""
HEARTBEAT = 1.0
"""An unchanged state is repeated after this time [s]."""


class Channel(ABC):
    """Ticks at a rate and hands out frames. For one event loop.

    Args:
        request: What its clients ask for.
        period: Time between two ticks [s].

    Attributes:
        clients: How many clients use it; it ticks while there are any.
    """

    def __init__(self, request: StreamRequest, period: float) -> None:
        self.request = request
        self.clients = 0
        self._period = period
        self._ticked = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self._failure: BaseException | None = None

    @property
    @abstractmethod
    def beginning(self) -> int:
        """What a new client fetches after."""

    @abstractmethod
    async def fetch(self, after: int) -> Frame:
        """Return the newest frame with a number above `after`; wait for it."""

    @abstractmethod
    async def tick(self) -> None:
        """Make what there is to fetch."""

    def join(self) -> None:
        """Count a client in."""
        self.clients += 1
        if self._task is None:
            self._task = asyncio.create_task(self._run())

    def leave(self) -> None:
        """Count a client out."""
        self.clients -= 1
        if self.clients == 0 and self._task is not None:
            self._task.cancel()
            self._task = None

    async def next_tick(self) -> None:
        """Return after the next tick.

        Raises:
            RuntimeError: The channel broke down; its cause says why.
        """
        if self._failure is None:
            await self._ticked.wait()
        if self._failure is not None:
            raise RuntimeError(f"{self.request.topic} broke down") from self._failure

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        deadline = loop.time()
        try:
            while True:
                await self.tick()
                self._wake()
                deadline = max(deadline + self._period, loop.time())
                await asyncio.sleep(deadline - loop.time())
        except Exception as error:  # noqa: BLE001 - kept; every client is told
            self._failure = error
            self._wake()

    def _wake(self) -> None:
        ticked, self._ticked = self._ticked, asyncio.Event()
        ticked.set()


class StateChannel(Channel):
    """The newest state at a rate.

    Args:
        request: What its clients ask for.
        topic: Where the state comes from.
        rate: Frames per second [Hz].
    """

    def __init__(self, request: StreamRequest, topic: Topic, rate: float) -> None:
        super().__init__(request, 1.0 / rate)
        self._topic = topic
        self._frame = Frame(0, None, None)
        self._cycle = 0
        self._made_at = 0.0

    @property
    @override
    def beginning(self) -> int:
        return max(0, self._frame.seq - 1)

    @override
    async def fetch(self, after: int) -> Frame:
        while self._frame.seq <= after:
            await self.next_tick()
        return self._frame

    @override
    async def tick(self) -> None:
        payload = await self._topic.latest()
        now = asyncio.get_running_loop().time()
        if payload is None:
            return
        if payload.cycle == self._cycle and now - self._made_at < HEARTBEAT:
            return
        self._cycle = payload.cycle
        self._made_at = now
        self._frame = encode(
            self._topic.name,
            payload,
            seq=self._frame.seq + 1,
            format=self.request.format,
            fields=self.request.fields,
        )


class FullChannel(Channel):
    """Every cycle, in batches; a frame's number is that of its last cycle.

    Args:
        request: What its clients ask for.
        topic: Where the samples come from.
    """

    def __init__(self, request: StreamRequest, topic: CycleTopic) -> None:
        super().__init__(request, BATCH_PERIOD)
        self._topic = topic
        self._newest = topic.newest_cycle()
        self._batches: dict[int, Frame] = {}

    @property
    @override
    def beginning(self) -> int:
        return self._newest

    @override
    async def fetch(self, after: int) -> Frame:
        while True:
            if after < self._newest:
                frame = self._batches.get(after) or self._batch(after)
                if frame is not None:
                    return frame
            await self.next_tick()

    @override
    async def tick(self) -> None:
        self._newest = self._topic.newest_cycle()
        self._batches.clear()

    def _batch(self, after: int) -> Frame | None:
        # Clients that keep up ask for the same batch until the next tick.
        limit = min(BATCH_LIMIT, self._newest - after)
        payload = self._topic.since(after, limit)
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


def open_channel(request: StreamRequest, topic: Topic) -> Channel:
    """Return a channel for what a client asks for.

    Raises:
        TypeError: Every cycle of a topic that has no sample in every cycle.
    """
    if request.rate is not None:
        return StateChannel(request, topic, request.rate)
    if isinstance(topic, CycleTopic):
        return FullChannel(request, topic)
    raise TypeError(f"{topic.name} cannot be streamed in full")
