"""Clients that say nothing, send slowly, do not read, or come in crowds."""

import asyncio
import errno
import socket
import threading
from contextlib import ExitStack

import pytest
import uvicorn

from station.web import limited_server
from station.web.limited_server import (
    MOST_CONNECTIONS,
    LimitedServer,
    Phase,
    connection_share,
)
from tests.waiting import PATIENCE, wait_until

LARGE = 32 * 1024 * 1024


async def app(scope, receive, send):
    """Read the body; answer shortly, or at length to `/large`."""
    while (await receive()).get("more_body"):
        pass
    body = b"x" * (LARGE if scope["path"] == "/large" else 2)
    headers = [(b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": body, "more_body": True})
    await send({"type": "http.response.body", "body": b""})


class Serving:
    """A context in which the app is served with that many connections at most."""

    def __init__(self, most):
        self._asked = threading.Event()
        config = uvicorn.Config(self._answer, log_level="error", lifespan="off")
        self.server = LimitedServer(config, most)
        self._thread = threading.Thread(target=self._run)
        self._listener = socket.create_server(("127.0.0.1", 0))

    async def _answer(self, *request):
        self._asked.set()
        await app(*request)

    def _run(self):
        async def serve():
            self.loop = asyncio.get_running_loop()
            await self.server.serve(sockets=[self._listener])

        asyncio.run(serve())

    def __enter__(self):
        self._thread.start()
        assert wait_until(lambda: self.server.started, pause=0.002)
        return self

    def __exit__(self, *_):
        self.server.should_exit = self.server.force_exit = True
        self._thread.join(PATIENCE)

    def wait_until_alone(self):
        """Wait until the server has a connection no more, after it had a request."""
        assert self._asked.wait(PATIENCE)
        connections = self.server.server_state.connections
        assert wait_until(lambda: not connections, pause=0.002)

    def wait_for(self, count):
        """Wait until the server has that many connections."""
        connections = self.server.server_state.connections
        assert wait_until(lambda: len(connections) >= count, pause=0.002)

    def connect(self, sent=b""):
        """Return a connection on which that was sent."""
        raw = socket.create_connection(self._listener.getsockname())
        raw.settimeout(PATIENCE)
        raw.sendall(sent)
        return raw


def answer(raw):
    """Return everything until the server ends the connection."""
    received = b""
    try:
        while data := raw.recv(65536):
            received += data
    except ConnectionResetError:
        return received
    return received


@pytest.fixture(autouse=True)
def unlimited(monkeypatch):
    """Lift all time limits, which would end what another reason should end."""
    monkeypatch.setattr(limited_server, "TIME_LIMITS", {})


@pytest.fixture
def impatient(monkeypatch):
    """Shorten all time limits."""
    monkeypatch.setattr(limited_server, "LOOK_PERIOD", 0.01)
    limits = dict.fromkeys((Phase.REQUEST, Phase.BODY, Phase.ANSWER), 0.1)
    monkeypatch.setattr(limited_server, "TIME_LIMITS", limits)


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize(
    "beginning",
    [
        b"",
        b"POST / HTTP/1.1\r\nHost: a\r\nX-Slow: ",
        b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 100000\r\n\r\nx",
        b"GET / HTTP/1.1\r\nHost: a\r\n\r\nGET / HTTP/1.1\r\nX-Slow: ",
    ],
    ids=["nothing", "header", "body", "second header"],
)
def test_a_request_that_arrives_drop_by_drop_is_given_up(beginning):
    with Serving(8) as server, server.connect(beginning) as raw:

        def is_given_up():
            try:
                raw.sendall(b"x")
            except (ConnectionResetError, BrokenPipeError):
                return True
            return False

        assert wait_until(is_given_up)


@pytest.mark.usefixtures("impatient")
def test_a_client_that_does_not_read_its_answer_is_given_up():
    request = b"GET /large HTTP/1.1\r\nHost: a\r\n\r\n"
    with Serving(8) as server, server.connect(request) as raw:
        server.wait_until_alone()
        assert len(answer(raw)) < LARGE


def test_a_newcomer_takes_the_place_of_who_has_waited_longest():
    with Serving(4) as server, ExitStack() as stack:
        silent = [stack.enter_context(server.connect()) for _ in range(4)]
        for _ in range(20):
            stack.enter_context(server.connect(b"POST / HTTP/1.1\r\n"))
        with server.connect(
            b"POST /stop HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"
        ) as stop:
            assert b"200 OK" in answer(stop)
        assert answer(silent[0]) == b""


def test_connections_leave_descriptors_to_the_process(monkeypatch):
    assert connection_share() <= MOST_CONNECTIONS
    monkeypatch.setattr(limited_server.resource, "getrlimit", lambda _: (128, 128))
    assert 4 <= connection_share() <= 128 - 40 - 24
    assert 4 <= connection_share(3) <= (128 - 40 - 24) // 3
    monkeypatch.setattr(limited_server.resource, "getrlimit", lambda _: (16, 16))
    assert connection_share() == 4
    monkeypatch.setattr(limited_server.resource, "getrlimit", lambda _: (-1, -1))
    assert connection_share() == MOST_CONNECTIONS


@pytest.mark.parametrize("coding", [b"chunked", b"Chunked"])
def test_a_request_with_two_lengths_is_refused_and_its_connection_ends(coding):
    request = (
        b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\nTransfer-Encoding: "
        + coding
        + b"\r\n\r\n0\r\n\r\nGET /smuggled HTTP/1.1\r\nHost: a\r\n\r\n"
    )
    with Serving(4) as server, server.connect(request) as raw:
        answers = answer(raw)  # until the server ends the connection

    assert answers.startswith(b"HTTP/1.1 400")
    assert answers.count(b"HTTP/1.1") == 1
    assert b"connection: close" in answers.lower()


def test_who_has_waited_longest_gives_way_when_no_file_can_be_opened(caplog):
    with Serving(8) as server, ExitStack() as stack:
        silent = [stack.enter_context(server.connect()) for _ in range(3)]
        server.wait_for(3)
        trouble = {"exception": OSError(errno.EMFILE, "Too many open files")}
        server.loop.call_soon_threadsafe(
            server.server._on_trouble, server.loop, trouble
        )
        assert [answer(raw) for raw in silent] == [b""] * 3

    assert "ulimit -n" in caplog.text


def test_other_troubles_are_told_as_ever(caplog):
    with Serving(8) as server:
        server.server._on_trouble(server.loop, {"message": "something else"})

    assert "something else" in caplog.text
