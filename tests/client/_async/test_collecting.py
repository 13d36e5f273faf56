"""Collecting ends when the station time has passed."""

import asyncio
from contextlib import asynccontextmanager

import numpy as np

from station.client import AsyncStationClient
from station.wire import StreamFrame


class FakeStream:
    """Batches of ten cycles of 1 ms."""

    def __init__(self):
        self.batches = 0

    async def wait_for(self, predicate, timeout):
        """Return the next batch."""
        first, self.batches = 10 * self.batches, self.batches + 1
        samples = [
            {"stamp": n / 1000, "position": [n]} for n in range(first, first + 10)
        ]
        data = {"name": ["a"], "samples": samples, "lost": 0}
        return StreamFrame(topic="joint_states", seq=1, epoch=1, stamp=0.0, data=data)


class FakeStation(AsyncStationClient):
    """A station that streams."""

    def __init__(self):
        super().__init__("http://a", "t")
        self.opened = []
        self.given = FakeStream()

    def stream(self, topic, **options):
        """Return the stream."""
        self.opened.append((topic, options))

        @asynccontextmanager
        async def enter():
            yield self.given

        return enter()


def test_every_cycle_of_the_time_is_collected():
    station = FakeStation()

    samples = asyncio.run(station.collect(0.025))

    np.testing.assert_array_equal(samples["position"][:, 0], np.arange(26))
    assert station.given.batches == 3
    assert station.opened == [("joint_states", {"rate": "full", "reconnect": False})]
