"""The command stream for plain Python; `tests/api/streams` tries the answers."""

import asyncio
import json
import time
from types import SimpleNamespace

import pytest

from station.api.streams import command_stream
from station.client import ApiError, StationClient, StationUnreachableError, streams
from station.core.clock import SystemClock
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.spring import make_station
from tests.waiting import PATIENCE, wait_until


@pytest.fixture
def station(monkeypatch):
    """Return a station whose loop runs in real time."""
    monkeypatch.setattr(command_stream, "REPORT_PERIOD", 0.02)
    station = make_station(SystemClock())
    station.loop.start()
    yield station
    station.loop.stop()


@pytest.fixture
def client(served):
    with StationClient(served.url, OPERATOR) as client:
        client.load_controller("spring", "test/Spring", {"joint": "j"})
        client.switch_controllers(start=["spring"])
        yield client


def test_set_points_are_sent_and_counted(client):
    with client.command_stream("spring") as stream:
        deadline = time.monotonic() + PATIENCE
        while stream.counts is None or not stream.counts.applied:
            assert time.monotonic() < deadline
            stream.send([0.5])

    assert stream.counts.error is None


def test_whoever_sends_in_a_tight_loop_still_reads_the_reports(monkeypatch):
    counts = ("received", "applied", "superseded", "refused", "pending", "cycle")
    report = json.dumps({**dict.fromkeys(counts, 3), "epoch": 1, "error": None})

    async def take(*_):
        """Take a message at once, as a link does whose buffers are empty."""

    async def report_once():
        connection.recv = asyncio.Future  # which never comes
        return report

    async def connect(*_, **__):
        return connection

    async def send_on():
        options = streams.CommandOptions("http://nowhere", None, None, "spring")
        stream = streams.AsyncCommandStream(options)
        await stream.__aenter__()
        for _ in range(3):
            await stream.send([0.5])
        return stream.counts

    connection = SimpleNamespace(send=take, recv=report_once)
    monkeypatch.setattr(streams, "connect", connect)
    assert asyncio.run(send_on()).received == 3


def _send_on(stream):
    while True:
        stream.send([0.5])


def test_a_refusal_says_why(served):
    with StationClient(served.url, VIEWER) as viewer:
        stream = viewer.command_stream("spring")
        with pytest.raises(ApiError) as refused, stream:
            _send_on(stream)
    assert refused.value.code == "forbidden"


def test_a_stream_that_is_not_open_sends_nothing(client):
    with pytest.raises(StationUnreachableError, match="with"):
        client.command_stream("spring").send([0.5])


def test_a_stream_can_be_opened_again(client):
    stream = client.command_stream("spring")
    for _ in range(2):
        with stream:
            stream.send([0.5])

    with pytest.raises(StationUnreachableError, match="with"):
        stream.send([0.5])


def test_what_was_sent_last_goes_out_before_the_end(client):
    with client.command_stream("spring") as stream:
        stream.send([0.125])

    assert wait_until(lambda: client.last_command("spring").last == [0.125])
