"""Streams of set-points: the newest wins, and everybody is told what became of his."""

import json
import time

import httpx
import msgspec.msgpack
import pytest
from websockets.exceptions import ConnectionClosed

from station.api.json_route import DoubleNameError
from station.api.streams import command_stream
from station.client import ApiError, StationClient
from station.core.clock import SystemClock
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.spring import make_station
from tests.api.test_server import open_stream
from tests.waiting import PATIENCE, wait_until

TOPIC = "command/spring"


@pytest.fixture
def station():
    """Return a station whose loop runs in real time."""
    return make_station(SystemClock())


@pytest.fixture(autouse=True)
def spring(live, station, monkeypatch):
    """Return a client of a running loop whose controller `spring` runs."""
    monkeypatch.setattr(command_stream, "REPORT_PERIOD", 0.02)
    station.loop.start()
    live.load_controller("spring", "test/Spring", {"joint": "j"})
    live.switch_controllers(start=["spring"])
    yield live
    station.loop.stop()


def counts(stream):
    return json.loads(stream.recv(timeout=PATIENCE))


def settled(stream, received):
    """Return the counts once all set-points are accounted for."""
    while True:
        found = counts(stream)
        if found["received"] == received and not found["pending"]:
            return found


def target(station):
    return station.manager.get_controller("spring").target


@pytest.mark.parametrize(
    "message",
    ['{"command": [0.5], "epoch": 1}', "[0.5]"],
)
def test_a_set_point_reaches_the_controller(server, station, message):
    with open_stream(server, TOPIC) as stream:
        stream.send(message)
        found = settled(stream, 1)

    assert (found["applied"], found["refused"], found["error"]) == (1, 0, None)
    assert target(station) == 0.5


def test_set_points_can_be_msgpack(server, station):
    with open_stream(server, TOPIC, query="?format=msgpack") as stream:
        stream.send(msgspec.msgpack.encode({"command": [0.5]}))
        found = msgspec.msgpack.decode(stream.recv(timeout=PATIENCE))

    assert found["received"] == 1
    assert target(station) == 0.5


def test_thirteen_thousand_at_once_the_newest_wins_and_all_are_counted(server, station):
    most = 13_000
    with open_stream(server, TOPIC) as stream:
        for number in range(most):
            stream.send(f"[{number / most}]")
        found = settled(stream, most)

    assert target(station) == (most - 1) / most
    assert found["applied"] + found["superseded"] == most
    assert found["superseded"] > 0
    assert found["refused"] == 0


@pytest.mark.parametrize(
    ("message", "code"),
    [
        ('{"command": [5.0]}', "invalid_command"),
        ('{"command": [0.1, 0.2]}', "invalid_command"),
        ('{"command": [0.1], "epoch": 99}', "stale_epoch"),
        ('{"command": [NaN]}', "invalid_request"),
        ('{"command": ["0.1"]}', "invalid_request"),
        ('{"command": [0.1], "timeout": 0}', "invalid_request"),
        ('{"command": [0.1], "timeout": 9}', "invalid_request"),
        ("nonsense", "invalid_request"),
        ("7", "invalid_request"),
    ],
)
def test_a_wrong_set_point_is_refused_and_the_stream_goes_on(server, message, code):
    with open_stream(server, TOPIC) as stream:
        stream.send(message)
        found = settled(stream, 1)
        stream.send("[0.5]")
        after = settled(stream, 2)

    assert (found["refused"], found["error"]["code"]) == (1, code)
    assert "pydantic" not in found["error"]["detail"]
    assert after["applied"] == 1


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            '{"command": [NaN]}',
            "message is no JSON at character 13: JSON has no NaN",
        ),
        ("nonsense", "The message is no JSON: invalid literal, expected 'null', at"),
        ("7", "The message must be an object."),
        ('{"command": ["0.1"]}', "command/0: must be a number."),
        (
            '{"command": [0.1], "command": [0.5]}',
            "The message has the key 'command' twice in one object.",
        ),
    ],
)
def test_a_refusal_says_what_is_wrong_with_the_message(server, message, said):
    with open_stream(server, TOPIC) as stream:
        stream.send(message)
        assert said in settled(stream, 1)["error"]["detail"]


PAIR = msgspec.msgpack.encode("command") + msgspec.msgpack.encode([0.5])


@pytest.mark.parametrize("head", [b"\x80", b"\xde" + bytes(2), b"\xdf" + bytes(4)])
def test_a_key_that_comes_twice_in_msgpack_is_refused(head):
    def read(pairs):
        message = head[:-1] + bytes([head[-1] + pairs]) + pairs * PAIR
        return command_stream._read(message, "msgpack")

    assert read(1).command == [0.5]
    with pytest.raises(DoubleNameError, match="has a key twice in one object"):
        read(2)


def test_silence_lets_the_set_point_expire(server, station):
    port = station.manager.get_controller("spring").set_points
    with open_stream(server, TOPIC, query="?timeout=0.01") as stream:
        stream.send("[0.5]")
        settled(stream, 1)
        assert wait_until(port.take_expiry)


@pytest.mark.parametrize(
    ("topic", "token", "code"),
    [
        (TOPIC, VIEWER, 4403),
        (TOPIC, "nonsense", 4401),
        ("command/unknown", OPERATOR, 4404),
        (TOPIC + "?timeout=0", OPERATOR, 4400),
        (TOPIC + "?timeout=soon", OPERATOR, 4400),
        (TOPIC + "?format=xml", OPERATOR, 4400),
        (TOPIC + "?rate=5", OPERATOR, 4400),
    ],
)
def test_who_and_what_is_wrong_is_refused(server, topic, token, code):
    headers = {"Authorization": f"Bearer {token}"}
    with (
        open_stream(server, topic, headers) as stream,
        pytest.raises(ConnectionClosed) as closed,
    ):
        stream.recv(timeout=PATIENCE)

    assert closed.value.rcvd.code == code


def test_while_somebody_else_holds_control_there_is_no_stream(spring, server):
    with (
        spring.control(owner="Ada"),
        open_stream(server, TOPIC) as stream,
        pytest.raises(ConnectionClosed) as closed,
    ):
        stream.recv(timeout=PATIENCE)

    assert closed.value.rcvd.code == 4423
    assert "Ada holds control" in closed.value.rcvd.reason


def test_a_stream_ends_when_control_is_taken_by_force(spring, server):
    with spring.control(owner="Ada"), spring.command_stream("spring") as stream:
        stream.send([0.5])
        headers = {"Authorization": f"Bearer {OPERATOR}"}
        url = f"{server.url}/api/v1/control"
        body = {"owner": "Eve", "force": True}
        httpx.post(url, json=body, headers=headers, trust_env=False)
        with pytest.raises(ApiError) as refused:
            _send_until_refused(stream)
    assert refused.value.code == "control_held"


def _send_until_refused(stream):
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        stream.send([0.4])


def test_a_stream_ends_with_its_token(spring, server):
    made = spring.tokens.create("ada")
    with (
        StationClient(server.url, made.token) as ada,
        ada.command_stream("spring") as stream,
    ):
        spring.tokens.revoke("ada")
        with pytest.raises(ApiError) as refused:
            _send_until_refused(stream)
    assert refused.value.code == "unauthorized"


def test_a_stream_leaves_events_with_its_counts(spring, server):
    with open_stream(server, TOPIC) as stream:
        stream.send("[0.5]")
        settled(stream, 1)

    def both():
        found = spring.events(kinds=["command_stream"])
        return found if len(found) > 1 else []

    ended = wait_until(both)
    assert [event.result for event in ended] == ["open", "closed"]
    assert ended[1].details["applied"] == 1
