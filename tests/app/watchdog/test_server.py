"""The watchdog's listener, over real sockets and a clock of the test."""

import hashlib
import json
import select
import socket

import pytest

from station.app.watchdog.server import CONNECTIONS, WatchdogServer
from tests.app.watchdog.bench import NOW, OPERATOR, VIEWER, Bench
from tests.waiting import PATIENCE, wait_until


class Visit:
    """A server, and clients that connect to it.

    Attributes:
        now: What the watchdog's clock says [s].
    """

    def __init__(self, folder):
        self.bench = Bench(folder)
        listener = socket.create_server(("127.0.0.1", 0))
        self._address = listener.getsockname()
        self.now = NOW
        self.server = WatchdogServer(
            listener,
            self.bench.settings,
            self.bench.watch,
            clock=lambda: self.now,
            request_time=0.2,
        )
        self.clients = []

    def connect(self):
        """Return a new client, which the server has taken."""
        client = socket.create_connection(self._address, timeout=PATIENCE)
        self.clients.append(client)
        select.select([self.server], [], [], 10.0)
        self.server.handle_request()
        return client

    def ask(self, line, token=None, body=""):
        """Send a request and return status and body of its answer."""
        client = self.connect()
        head = f"{line} HTTP/1.1\r\nHost: x\r\nContent-Length: {len(body)}\r\n"
        if token is not None:
            head += f"Authorization: Bearer {token}\r\n"
        client.send(f"{head}\r\n{body}".encode())
        return self.answer(client)

    def answer(self, client):
        """Return status and body of a client's answer; None and None without one."""
        received = b""
        while data := client.recv(65_536):
            received += data
        if not received:
            return None, None
        head, _, content = received.partition(b"\r\n\r\n")
        return int(head.split()[1]), json.loads(content)

    def close(self):
        for client in self.clients:
            client.close()
        self.server.server_close()


@pytest.fixture
def visit(tmp_path):
    """Return a server with its visitors."""
    made = Visit(tmp_path)
    yield made
    made.close()


def test_ready_needs_no_token(visit):
    status, body = visit.ask("GET /ready")

    assert (status, body["ready"]) == (200, True)


def test_not_ready_says_why(visit):
    visit.now += 1.0
    status, body = visit.ask("GET /ready")

    assert (status, body["code"]) == (503, "not_ready")
    assert "stood still" in body["detail"]


@pytest.mark.parametrize("token", [None, "", "wrong", OPERATOR[:-1], "ü"])
@pytest.mark.parametrize("line", ["POST /stop", "GET /incident", "GET /anything"])
def test_everything_else_needs_a_token(visit, line, token):
    assert visit.ask(line, token)[0] == 401
    assert not visit.bench.heartbeat.is_stop_asked


@pytest.mark.parametrize("token", [OPERATOR, VIEWER])
def test_every_role_can_stop(visit, token):
    status, body = visit.ask("POST /stop", token)

    assert (status, body["carried_out"]) == (200, False)
    assert "latched" in body["detail"]
    assert visit.bench.heartbeat.is_stop_asked


def test_a_stop_that_the_loop_carries_out_is_said_to_be(visit):
    client = visit.connect()
    head = f"POST /stop HTTP/1.1\r\nAuthorization: Bearer {VIEWER}\r\n\r\n"
    client.send(head.encode())
    assert wait_until(lambda: visit.bench.heartbeat.is_stop_asked)
    visit.bench.heartbeat.confirm_stop()

    assert visit.answer(client)[1]["carried_out"] is True


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ('{"reason": "smoke"}', "smoke (the operator"),
        ("", "no reason given (the operator"),
        ("[1", "no reason given"),
        ('{"reason": 3}', "no reason given"),
    ],
)
def test_the_reason_is_kept_and_never_in_the_way(visit, body, reason):
    assert visit.ask("POST /stop", OPERATOR, body)[0] == 200
    assert visit.bench.heartbeat.stop_reason().startswith(reason)


def test_an_incident_is_shown(visit):
    assert visit.ask("GET /incident", VIEWER)[0] == 404

    visit.bench.look(0.1)
    status, body = visit.ask("GET /incident", VIEWER)

    assert (status, body["station_pid"]) == (200, 4711)


def test_unknown_paths_are_not_found(visit):
    assert visit.ask("GET /other", OPERATOR)[0] == 404


@pytest.mark.parametrize(
    "sent",
    [b"x" * 9000, b"\r\n\r\n", b"\xff\xfe a \r\n\r\n", b"GET /ready HTTP/\xff\r\n\r\n"],
)
def test_nonsense_does_no_harm(visit, sent):
    client = visit.connect()
    client.send(sent)

    assert visit.answer(client)[0] in {None, 400}
    assert visit.ask("GET /ready")[0] == 200


def test_other_methods_are_refused(visit):
    assert visit.ask("PUT /stop", OPERATOR)[0] == 501
    assert not visit.bench.heartbeat.is_stop_asked


def test_a_stop_whose_body_never_comes_is_carried_out(visit):
    client = visit.connect()
    client.send(
        f"POST /stop HTTP/1.1\r\nAuthorization: Bearer {VIEWER}\r\n"
        "Content-Length: 20\r\n\r\n".encode()
    )

    assert visit.answer(client)[0] == 200
    assert visit.bench.heartbeat.stop_reason().startswith("no reason given")


def test_a_silent_client_is_dropped(visit):
    client = visit.connect()

    assert visit.answer(client) == (None, None)


def test_idle_clients_do_not_keep_a_stop_out(visit):
    for _ in range(CONNECTIONS + 5):
        visit.connect()

    assert visit.ask("POST /stop", VIEWER)[0] == 200


def digest_of(token):
    return hashlib.sha256(token.encode()).hexdigest()


def test_a_named_token_stops_until_it_ends(visit):
    visit.server.take_token(digest_of("ada"), "viewer", None)
    visit.bench.heartbeat.beats[0] = NOW

    assert visit.ask("GET /incident", "ada")[0] == 404  # known, and nothing happened
    visit.server.take_token(digest_of("ada"), "", None)
    assert visit.ask("GET /incident", "ada")[0] == 401


def test_a_named_token_that_has_expired_is_refused(visit):
    visit.server.take_token(digest_of("eve"), "operator", 1.0)  # in the year 1970

    assert visit.ask("GET /incident", "eve")[0] == 401
