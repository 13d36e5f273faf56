"""Control for the length of a block, kept by heartbeats."""

import asyncio
import threading

import httpx
import pytest

from station import wire
from station.client import (
    ApiError,
    AsyncStationClient,
    StationUnreachableError,
    lease,
)
from station.client.blocking import _BlockingConnection
from station.client.connection import AsyncConnection
from tests.api.conftest import OPERATOR
from tests.client.recorder import Recorder


def test_control_lasts_as_long_as_the_block(served):
    async def work():
        async with (
            AsyncStationClient(served.url, OPERATOR) as ada,
            AsyncStationClient(served.url, OPERATOR) as eve,
        ):
            async with ada.control(owner="Ada") as held:
                await ada.reset_loop_statistics()
                with pytest.raises(ApiError, match="Ada"):
                    await eve.reset_loop_statistics()
                assert held.lost is None
            await eve.reset_loop_statistics()

    asyncio.run(work())


def test_a_loss_is_noticed_by_the_heartbeat(served):
    async def work():
        async with (
            AsyncStationClient(served.url, OPERATOR) as ada,
            AsyncStationClient(served.url, OPERATOR) as eve,
            ada.control(owner="Ada", ttl=0.5) as held,
            eve.control(owner="Eve", force=True),
        ):
            async with asyncio.timeout(5.0):
                while held.lost is None:
                    await asyncio.sleep(0)
            return held.lost

    assert "Eve holds control" in str(asyncio.run(work()))


FREE = {"owner": None, "lease": None}


def test_requests_of_control():
    recorder = Recorder(FREE)

    recorder.run(lambda client: client.lease.state())
    recorder.run(lambda client: client.lease.take("ada", ttl=5.0, force=True))
    recorder.run(lambda client: client.lease.renew(hand_over_to="grace"))
    recorder.run(lambda client: client.lease.release())

    assert recorder.requests == [
        ("GET", "/api/v1/control", None),
        ("POST", "/api/v1/control", {"owner": "ada", "ttl": 5.0, "force": True}),
        ("PATCH", "/api/v1/control", {"hand_over_to": "grace"}),
        ("DELETE", "/api/v1/control", None),
    ]


REFUSAL = ApiError("Eve holds control.", status=423, code="control_held", remedy="")


class Beaten:
    """A connection that takes control, then has no link, then is refused."""

    def __init__(self):
        super().__init__("http://a", "t", 1.0, httpx.MockTransport(None), None)
        self.outcomes = [None, None, StationUnreachableError("u", OSError()), REFUSAL]
        self.methods = []

    async def send(self, method, *_):
        """Do as told once per request; refuse from then on."""
        self.methods.append(method)
        outcome = self.outcomes.pop(0) if self.outcomes else REFUSAL
        if outcome is not None:
            raise outcome
        return wire.ControlState(owner="Ada", lease="l")


class BeatenInTask(Beaten, AsyncConnection):
    """It beats in a task."""


class BeatenInThread(Beaten, _BlockingConnection):
    """It beats in a thread."""


@pytest.mark.parametrize("kind", [BeatenInTask, BeatenInThread])
def test_a_heartbeat_goes_on_without_a_link_and_ends_with_a_refusal(monkeypatch, kind):
    monkeypatch.setattr(lease, "BEATS", 1000.0)
    connection = kind()

    async def work():
        async with lease.AsyncControlLease(connection, "Ada", 0.5, force=False) as held:
            async with asyncio.timeout(5.0):
                while held.lost is None:
                    await asyncio.sleep(0)
        return held.lost

    assert asyncio.run(work()) is REFUSAL
    assert connection.methods == ["POST", "PATCH", "PATCH", "PATCH", "DELETE"]
    assert connection.lease is None


@pytest.mark.parametrize("kind", [AsyncConnection, _BlockingConnection])
def test_what_is_repeated_can_be_stopped(kind):
    async def work():
        connection = kind("http://a", "t", 1.0, httpx.MockTransport(None), None)
        beats, enough = [], threading.Event()

        async def act():
            beats.append(1)
            if len(beats) == 3:
                enough.set()
            return True

        stop = connection.repeat(act, 0.001)
        async with asyncio.timeout(5.0):
            while not enough.is_set():
                await asyncio.sleep(0)
        await stop()
        counted = len(beats)
        await asyncio.sleep(0.01)
        return counted == len(beats)

    assert asyncio.run(work())
