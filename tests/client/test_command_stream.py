"""The command stream for plain Python; `tests/api/streams` tries the answers."""

import time

import pytest

from station.api.streams import command_stream
from station.client import ApiError, StationClient, StationUnreachableError
from station.core.clock import SystemClock
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.spring import make_station


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
        deadline = time.monotonic() + 5.0
        while stream.counts is None or not stream.counts.applied:
            assert time.monotonic() < deadline
            stream.send([0.5])

    assert stream.counts.error is None


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

    deadline = time.monotonic() + 5.0
    while client.last_command("spring").last != [0.125]:
        assert time.monotonic() < deadline
