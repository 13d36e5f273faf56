"""Streams over a real connection: hello, frames, refusals, slow clients."""

import json
import socket
from contextlib import ExitStack

import httpx
import msgspec
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.protocol import CLIENT, Protocol
from websockets.sync.client import connect

from station.api import auth
from station.api.app import create_app
from station.api.auth import SESSION_LIFETIME, Authenticator
from station.api.server import ApiServer
from station.core.clock import ManualClock
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.test_server import BEARER, deaf_client, open_stream
from tests.waiting import PATIENCE, wait_until


def close_code(stream):
    with stream, pytest.raises(ConnectionClosed) as caught:
        stream.recv(timeout=PATIENCE)
    assert caught.value.rcvd.reason
    return caught.value.rcvd.code


def read(stream):
    return json.loads(stream.recv(timeout=PATIENCE))


def test_hello_comes_first_with_a_snapshot_of_everything(server, station, live):
    live.load_controller("spring", "test/Spring", {"joint": "j"})

    with open_stream(server) as stream:
        hello = read(stream)

    assert hello["topic"] == "hello"
    assert hello["boot_id"] == station.boot_id
    assert (hello["epoch"], hello["stamp"]) == (1, 0.001)
    data = hello["data"]
    assert data["joint_states"]["position"] == [0.25]
    assert data["controllers"][0]["name"] == "spring"
    assert data["stop"]["state"] == "armed"


def test_frames_follow_the_cycles(server, station):
    with open_stream(server, query="?rate=200&fields=stamp,position") as stream:
        hello = read(stream)
        frame = read(stream)
        station.loop.step()
        later = read(stream)

    assert frame["seq"] > hello["seq"]
    assert frame["data"] == {"stamp": 0.001, "position": [0.25]}
    assert later["seq"] == frame["seq"] + 1
    assert later["stamp"] == 0.002
    assert "boot_id" not in later


def test_msgpack(server):
    with open_stream(server, query="?format=msgpack") as stream:
        assert msgspec.msgpack.decode(stream.recv())["topic"] == "hello"
        assert msgspec.msgpack.decode(stream.recv())["data"]["position"] == [0.25]


def test_every_cycle_arrives_once(server, station):
    with open_stream(server, query="?rate=full") as stream:
        seq = read(stream)["seq"]
        station.loop.step(300)
        cycles = []
        while not cycles or cycles[-1] < 301:
            frame = read(stream)
            assert frame["data"]["lost"] == 0
            cycles += [sample["cycle"] for sample in frame["data"]["samples"]]
    assert cycles == list(range(seq + 1, 302))


def test_what_a_client_says_is_ignored(server):
    with open_stream(server) as stream:
        stream.send("hello")
        stream.send(b"\x00" * 1000)
        assert read(stream)["topic"] == "hello"
        assert read(stream)["topic"] == "joint_states"


@pytest.mark.parametrize(
    "headers", [{}, {"Authorization": "Bearer wrong"}, {"Cookie": "station_0=x"}]
)
def test_no_token_is_4401(server, headers):
    assert close_code(open_stream(server, headers=headers)) == 4401


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://localhost"])
def test_a_page_elsewhere_is_4403(server, origin):
    stream = open_stream(server, headers={**BEARER, "Origin": origin})

    assert close_code(stream) == 4403


def test_a_name_that_dns_could_point_here_is_4403(server):
    raw = socket.create_connection(("127.0.0.1", server.port))
    stream = connect(
        f"ws://evil.example:{server.port}/api/v1/streams/loop",
        sock=raw,
        additional_headers=BEARER,
        proxy=None,
    )
    assert close_code(stream) == 4403


@pytest.mark.parametrize(
    ("topic", "query", "code"),
    [
        ("nothing", "", 4404),
        ("controller_state/nobody", "", 4404),
        ("joint_states", "?rate=abc", 4400),
        ("joint_states", "?rate=NaN", 4400),
        ("joint_states", "?fields=tau", 4400),
        ("controllers", "?rate=full&fields=controllers", 4400),
    ],
)
def test_what_cannot_be_had_has_its_close_code(server, topic, query, code):
    assert close_code(open_stream(server, topic, query=query)) == code


def test_a_ticket_opens_one_stream(server, live):
    ticket = live.stream_ticket().ticket

    with open_stream(server, headers={}, query=f"?ticket={ticket}") as stream:
        assert read(stream)["topic"] == "hello"
    again = open_stream(server, headers={}, query=f"?ticket={ticket}")
    assert close_code(again) == 4401


def test_a_browser_that_is_logged_in_may_watch_from_the_stations_own_page(server):
    login = httpx.post(f"{server.url}/api/v1/login", json={"token": VIEWER})
    cookie = "; ".join(f"{name}={value}" for name, value in login.cookies.items())

    with open_stream(
        server, headers={"Cookie": cookie, "Origin": server.url}
    ) as stream:
        assert read(stream)["topic"] == "hello"
    elsewhere = {"Cookie": cookie, "Origin": "http://127.0.0.1:1"}
    assert close_code(open_stream(server, headers=elsewhere)) == 4403


def test_a_viewer_may_watch(server):
    headers = {"Authorization": f"Bearer {VIEWER}"}

    with open_stream(server, headers=headers) as stream:
        assert read(stream)["topic"] == "hello"


def test_too_many_clients_are_turned_away(station, authenticator):
    app = create_app(station, authenticator, max_streams=1)
    with ApiServer(app, port=0) as server, open_stream(server) as first:
        read(first)
        assert close_code(open_stream(server)) == 1013


def test_clients_that_go_leave_nothing_behind(server, app):
    for _ in range(20):
        with open_stream(server) as stream:
            read(stream)
    broadcaster = app.state.services.broadcaster
    assert wait_until(lambda: broadcaster.clients == 0)


def test_a_client_that_reads_nothing_is_closed_4408_and_harms_nobody(
    station, authenticator
):
    app = create_app(station, authenticator, slow_after=0.2)
    with ApiServer(app, port=0) as server:
        raw = deaf_client(server)
        with open_stream(server, query="?rate=full") as good:
            seq = read(good)["seq"]
            # Until the buffers of the system are full, and the server finds out.
            while app.state.services.broadcaster.clients > 1:
                station.loop.step(250)
                frame = read(good)
                assert frame["data"]["lost"] == 0
                assert frame["seq"] > seq
                seq = frame["seq"]
        assert last_close_code(raw) == 4408


def last_close_code(raw):
    """Read everything at last, and return the code of the close frame."""
    protocol = Protocol(CLIENT, max_size=None)
    raw.settimeout(PATIENCE)
    head = b""
    while b"\r\n\r\n" not in head:
        head += raw.recv(1)
    while protocol.close_rcvd is None:
        data = raw.recv(65536)
        assert data, "the connection ended without a close frame"
        protocol.receive_data(data)
    raw.close()
    return protocol.close_rcvd.code


def log_in(server):
    """Return the header that proves a new session."""
    answer = httpx.post(f"{server.url}/api/v1/login", json={"token": OPERATOR})
    (cookie,) = answer.cookies.items()
    return {"Cookie": "=".join(cookie)}


def code_at_the_end(stream):
    with pytest.raises(ConnectionClosed) as caught:
        read_to_the_end(stream)
    return caught.value.rcvd.code


def read_to_the_end(stream):
    while True:
        stream.recv(timeout=PATIENCE)


def test_logging_out_ends_the_streams_of_that_session_alone(server):
    mine, other = log_in(server), log_in(server)
    tickets = f"{server.url}/api/v1/stream-tickets"
    ticket = httpx.post(tickets, headers=mine).json()["ticket"]
    with (
        open_stream(server, headers={}, query=f"?ticket={ticket}") as by_ticket,
        open_stream(server, headers=mine) as by_cookie,
        open_stream(server, headers=other) as of_another,
        open_stream(server) as by_token,
    ):
        for stream in (by_ticket, by_cookie, of_another, by_token):
            read(stream)

        answer = httpx.post(f"{server.url}/api/v1/logout", headers=mine)

        assert answer.status_code == 204
        assert code_at_the_end(by_ticket) == 4401
        assert code_at_the_end(by_cookie) == 4401
        assert read(of_another)["topic"] == "joint_states"
        assert read(by_token)["topic"] == "joint_states"


def test_an_expired_session_ends_its_streams(station, monkeypatch):
    monkeypatch.setattr(auth, "EXPIRY_PERIOD", 0.01)
    clock = ManualClock()
    app = create_app(station, Authenticator(OPERATOR, VIEWER, clock=clock))
    with (
        ApiServer(app, port=0) as server,
        open_stream(server, headers=log_in(server)) as stream,
    ):
        read(stream)
        clock.advance(SESSION_LIFETIME)
        assert code_at_the_end(stream) == 4401


def test_viewers_leave_streams_for_operators(station, authenticator):
    app = create_app(station, authenticator, max_streams=4)
    viewer = {"Authorization": f"Bearer {VIEWER}"}
    with ApiServer(app, port=0) as server, ExitStack() as stack:
        for _ in range(3):
            read(stack.enter_context(open_stream(server, headers=viewer)))
        assert close_code(open_stream(server, headers=viewer)) == 1013
        with open_stream(server) as stream:
            assert read(stream)["topic"] == "hello"


def test_one_session_leaves_streams_for_others(station, authenticator):
    app = create_app(station, authenticator, max_streams=8)
    with ApiServer(app, port=0) as server, ExitStack() as stack:
        headers = log_in(server)
        for _ in range(2):
            read(stack.enter_context(open_stream(server, headers=headers)))
        assert close_code(open_stream(server, headers=headers)) == 1013
        with open_stream(server) as stream:
            assert read(stream)["topic"] == "hello"
