"""The server in its thread: start, stop, ports, and what only a real net shows."""

import asyncio
import socket
import threading

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.api.server import ApiServer, ServerStartError, YieldingSelector
from station.local.tls import TlsFiles, TlsFilesError, trust
from tests.api.conftest import OPERATOR
from tests.api.test_errors import problem_of
from tests.certificates import make_certificate
from tests.waiting import PATIENCE, wait_until

BEARER = {"Authorization": f"Bearer {OPERATOR}"}


def open_stream(server, topic="joint_states", headers=BEARER, query=""):
    url = f"ws://127.0.0.1:{server.port}/api/v1/streams/{topic}{query}"
    return connect(url, additional_headers=headers, proxy=None, compression=None)


def test_port_0_is_any_free_port(server):
    assert server.port > 0
    assert server.url == f"http://127.0.0.1:{server.port}"
    assert httpx.get(f"{server.url}/api/v1/health").status_code == 200


def test_a_port_in_use_is_refused_with_a_way_out(server, app):
    with pytest.raises(ServerStartError, match=str(server.port)) as caught:
        ApiServer(app, port=server.port).start()

    assert "port" in caught.value.remedy


@pytest.mark.parametrize(
    ("host", "url"),
    [("0.0.0.0", "http://127.0.0.1:1"), ("::", "http://[::1]:1"), ("a", "http://a:1")],
)
def test_the_url_is_one_that_this_machine_can_use(app, host, url):
    assert ApiServer(app, host, 1).url == url


def test_stopping_twice_or_before_the_start_is_fine(app):
    server = ApiServer(app, port=0)
    server.stop()
    server.start()
    assert httpx.get(f"{server.url}/api/v1/health").status_code == 200
    server.stop()
    server.stop()
    assert not any(thread.name == "api" for thread in threading.enumerate())


def test_it_goes_quickly_with_open_streams_and_tells_them(app):
    server = ApiServer(app, port=0)
    server.start()
    streams = [open_stream(server) for _ in range(5)]
    for stream in streams:
        stream.recv()

    server.stop(PATIENCE)

    for stream in streams:
        with pytest.raises(ConnectionClosed) as caught:
            read_to_the_end(stream)
        assert caught.value.rcvd.code == 1001
        stream.close()
    assert not any(thread.name == "api" for thread in threading.enumerate())


def read_to_the_end(stream):
    while True:
        stream.recv(timeout=PATIENCE)


def test_it_goes_quickly_while_a_client_reads_nothing(app, station):
    server = ApiServer(app, port=0)
    server.start()
    raw = deaf_client(server)
    (protocol,) = server._server.server_state.connections

    def is_full():
        station.loop.step(250)
        return not protocol.writable.is_set()

    assert wait_until(is_full, pause=0.001)

    assert server._server.config.timeout_graceful_shutdown == 1
    server.stop(PATIENCE)

    assert not any(thread.name == "api" for thread in threading.enumerate())
    assert protocol.transport.get_write_buffer_size() == 0
    raw.close()


def deaf_client(server):
    """Open a stream of every cycle by hand and never read from it."""
    raw = socket.create_connection(("127.0.0.1", server.port))
    raw.sendall(
        b"GET /api/v1/streams/joint_states?rate=full HTTP/1.1\r\nHost: localhost\r\n"
        b"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        b"Authorization: Bearer " + OPERATOR.encode() + b"\r\n\r\n"
    )
    assert raw.recv(12) == b"HTTP/1.1 101"
    return raw


def test_a_large_body_without_a_length_is_refused_while_it_comes(server):
    def chunks():
        for _ in range(64):
            yield b" " * 16384

    with httpx.Client(base_url=server.url, headers=BEARER) as http:
        answer = http.post(
            "/api/v1/login",
            content=chunks(),
            headers={"Content-Type": "application/json"},
        )

    problem_of(answer, 413, "body_too_large")


def test_a_stop_waits_for_no_other_request(server, station, monkeypatch):
    """More requests than the server has workers, all of them stuck."""
    release = threading.Event()
    arrived = threading.Semaphore(0)

    def stuck():
        arrived.release()
        release.wait(2.0 * PATIENCE)
        return []

    monkeypatch.setattr(station, "controllers", stuck)

    def ask():
        httpx.get(f"{server.url}/api/v1/controllers", headers=BEARER, timeout=None)

    crowd = [threading.Thread(target=ask) for _ in range(45)]
    for thread in crowd:
        thread.start()
    for _ in range(40):
        assert arrived.acquire(timeout=PATIENCE)
    answer = httpx.post(f"{server.url}/api/v1/stop", headers=BEARER, timeout=PATIENCE)
    waiting = [thread.is_alive() for thread in crowd]
    release.set()
    for thread in crowd:
        thread.join()

    assert answer.json()["state"] == "stopped"
    assert all(waiting)


def test_answers_do_not_wait_for_acknowledgements(server):
    with httpx.Client(base_url=server.url, headers=BEARER) as http:
        http.get("/api/v1/joint_states")
        (connection,) = server._server.server_state.connections
        raw = connection.transport.get_extra_info("socket")

        # With Nagle's algorithm each answer would wait 40 ms.
        assert raw.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_it_does_not_say_what_it_is_made_of(server):
    assert "server" not in httpx.get(f"{server.url}/api/v1/health").headers


def test_with_tls_it_speaks_https_alone(app, tmp_path):
    tls = make_certificate(tmp_path)
    with ApiServer(app, port=0, tls=tls) as server:
        assert server.url == f"https://127.0.0.1:{server.port}"
        trusted = trust(server.url, tls.certificate)
        login = httpx.post(
            f"{server.url}/api/v1/login", json={"token": OPERATOR}, verify=trusted
        )
        with pytest.raises(httpx.TransportError):
            httpx.get(f"http://127.0.0.1:{server.port}/api/v1/health")

    assert login.status_code == 200
    assert "Secure" in login.headers["set-cookie"]


def test_a_certificate_that_cannot_be_used_is_told_at_once(app, tmp_path):
    tls = TlsFiles(tmp_path / "missing.crt", tmp_path / "missing.key")

    with pytest.raises(TlsFilesError, match=r"missing\.crt cannot be read"):
        ApiServer(app, port=0, tls=tls)


def test_a_turn_of_the_event_loop_lets_a_cycle_begin_before():
    class Cycle:
        given = 0

        def wait_if_cycle_is_due(self) -> None:
            self.given += 1

    cycle = Cycle()
    seen = []

    async def turn():
        seen.append(cycle.given)
        await asyncio.sleep(0)
        seen.append(cycle.given)

    loop = asyncio.SelectorEventLoop(YieldingSelector(cycle))
    try:
        loop.run_until_complete(turn())
    finally:
        loop.close()
    assert seen == [1, 2]
