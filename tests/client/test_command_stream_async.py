"""The command stream for asyncio."""

import asyncio

import pytest

from station.api.streams import command_stream
from station.client import ApiError, AsyncStationClient, StationUnreachableError
from station.core.clock import SystemClock
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.spring import make_station
from tests.waiting import PATIENCE


@pytest.fixture
def station(monkeypatch):
    """Return a station whose loop runs in real time."""
    monkeypatch.setattr(command_stream, "REPORT_PERIOD", 0.02)
    station = make_station(SystemClock())
    station.loop.start()
    yield station
    station.loop.stop()


def test_set_points_are_sent_and_counted(served):
    async def work():
        async with AsyncStationClient(served.url, OPERATOR) as client:
            await client.load_controller("spring", "test/Spring", {"joint": "j"})
            await client.switch_controllers(start=["spring"])
            async with client.command_stream("spring") as stream:
                while stream.counts is None or not stream.counts.applied:
                    await stream.send([0.5])
                    await asyncio.sleep(0)
                return stream.counts

    counts = asyncio.run(asyncio.wait_for(work(), PATIENCE))
    assert counts.refused == 0


def test_a_refusal_says_why(served):
    async def work():
        async with (
            AsyncStationClient(served.url, VIEWER) as client,
            client.command_stream("spring") as stream,
        ):
            while True:
                await stream.send([0.5])
                await asyncio.sleep(0)

    with pytest.raises(ApiError) as refused:
        asyncio.run(asyncio.wait_for(work(), PATIENCE))
    assert refused.value.code == "forbidden"


def test_a_stream_that_is_not_open_sends_nothing(served):
    stream = AsyncStationClient(served.url, OPERATOR).command_stream("spring")

    with pytest.raises(StationUnreachableError, match="with"):
        asyncio.run(stream.send([0.5]))
