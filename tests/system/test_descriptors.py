"""Clients that eat the file descriptors of a station do not keep a stop out."""

import resource
import socket
import time
from contextlib import ExitStack, contextmanager
from urllib.parse import urlsplit

import httpx
import pytest
from websockets.sync.client import connect

from station.client import StationClient
from tests.system.station_process import StationProcess

pytestmark = pytest.mark.long

DESCRIPTORS = 128
FEW = 44
SOON = 5.0
"""How long a stop may take on a slow machine [s]: one that is kept out is not answered
at all while the others hold their connections."""


@contextmanager
def limited(folder, files):
    """Run a station whose process may open so many files."""
    station = StationProcess(folder, "--no-ui")
    resource.prlimit(station.process.pid, resource.RLIMIT_NOFILE, (files, files))
    yield station
    station.clean_up()


@pytest.fixture(scope="module")
def shared_station(tmp_path_factory):
    """A station whose process may open 128 files."""
    with limited(tmp_path_factory.mktemp("station"), DESCRIPTORS) as station:
        yield station


@pytest.fixture
def station(shared_station):
    """The shared station, armed, so that a stop has something to change."""
    access = shared_station.access()
    with StationClient(access["url"], access["token"]) as client:
        if client.status().stop_state != "armed":
            client.release_stop()
            client.release_stop(arm=True)
        assert client.status().stop_state == "armed"
    return shared_station


@pytest.fixture
def poor_station(tmp_path):
    """A station whose process may hardly open a file."""
    with limited(tmp_path, FEW) as station:
        yield station


def stop(url, token):
    """Stop the station over a new connection; return how long that took [s]."""
    begin = time.monotonic()
    headers = {"Authorization": f"Bearer {token}"}
    answer = httpx.post(f"{url}/api/v1/stop", headers=headers, timeout=10.0)
    assert answer.status_code == 200
    assert answer.json()["state"] == "stopped"
    return time.monotonic() - begin


def test_the_stop_works_while_strangers_eat_descriptors(station):
    access = station.access()
    url, token = access["url"], access["token"]
    address = (urlsplit(url).hostname, urlsplit(url).port)
    beginnings = [b"", b"POST /api/v1/stop HTTP/1.1\r\nX: ", b"GET / HTTP/1.1\r\n"]

    with ExitStack() as stack:
        for number in range(3 * DESCRIPTORS):
            raw = stack.enter_context(socket.create_connection(address))
            raw.sendall(beginnings[number % len(beginnings)])
            if number % DESCRIPTORS == DESCRIPTORS - 1:
                assert stop(url, token) < SOON

    assert "out of system resource" not in station.errors


def test_the_stop_gets_in_where_hardly_a_file_can_be_opened(poor_station):
    access = poor_station.access()
    url, token = access["url"], access["token"]
    address = (urlsplit(url).hostname, urlsplit(url).port)

    with ExitStack() as stack:
        for number in range(4 * FEW):
            raw = stack.enter_context(socket.create_connection(address))
            raw.sendall(b"POST /api/v1/stop HTTP/1.1\r\nX: ")
            if number % FEW == FEW - 1:
                assert stop(url, token) < SOON

    assert "out of system resource" not in poor_station.errors
    assert f"may open {FEW} files only" in poor_station.errors


def test_the_stop_works_while_viewers_open_all_the_streams_they_can(station):
    access = station.access()
    url, viewer = access["url"], access["viewer_token"]
    # Rarely a frame: they are many, nobody reads them, and it is the files that count.
    address = url.replace("http", "ws") + "/api/v1/streams/joint_states?rate=1"
    headers = {"Authorization": f"Bearer {viewer}"}

    with ExitStack() as stack:
        for _ in range(64):
            stack.enter_context(
                connect(address, additional_headers=headers, proxy=None)
            )
        assert stop(url, access["token"]) < SOON

    assert "out of system resource" not in station.errors


def test_the_stop_works_while_strangers_leave_refused_streams_half_closed(station):
    access = station.access()
    url = access["url"]
    parts = urlsplit(url)
    handshake = (
        f"GET /api/v1/streams/joint_states HTTP/1.1\r\nHost: {parts.netloc}\r\n"
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    ).encode()

    with ExitStack() as stack:
        for _ in range(2 * DESCRIPTORS):
            raw = stack.enter_context(
                socket.create_connection((parts.hostname, parts.port))
            )
            raw.sendall(handshake)
        assert stop(url, access["token"]) < SOON

    assert "out of system resource" not in station.errors
