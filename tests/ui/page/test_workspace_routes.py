"""Requests that the gateway answers itself, and the desk of one browser."""

import json
import threading

import httpx
import pytest
from starlette.applications import Starlette
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.core.errors import ConfigError
from station.ui.page import workspace_routes
from station.ui.page.workspace_routes import WorkspaceParts, WorkspaceRoutes
from station.ui.sessions.sessions import Role, Sessions
from tests.ui.served import Served
from tests.ui.views import controller, element, sample, view
from tests.waiting import PATIENCE

NAMES = ("joint1", "joint2")


class _Client:
    """Stands for the station's client; takes every set-point."""

    async def __aenter__(self):
        return self

    async def __aexit__(self, *_):
        return None

    async def command(self, name, values, *, epoch):
        return None


class _Access:
    """Stands for the credentials of the sessions."""

    def __init__(self, client):
        self.client = client

    def client_of(self, session):
        assert session.role is Role.OPERATOR
        return self.client

    def renew(self, client, session):
        assert (client, session.role) == (self.client, Role.OPERATOR)

    def lease_of(self, session):
        assert session.role is Role.OPERATOR


class _Bench:
    """The workspace's routes, without the gateway before them."""

    def __init__(self):
        self.client = _Client()
        self.sessions = Sessions()
        self.session = None
        self.view = _running()
        parts = WorkspaceParts(lambda: self.view, _Access(self.client), 1500)
        self.routes = WorkspaceRoutes(parts, self.sessions, self._find).routes()

    def _find(self, connection):
        assert connection is not None
        return self.session


def _running(**changes):
    return view(
        controller("arm", "running", NAMES),
        elements={"arm": tuple(element(name) for name in NAMES)},
        samples={"arm": sample(1.0, desired=0.1, names=NAMES)},
        positions={"panda_joint1": 0.0},
        **changes,
    )


@pytest.fixture(scope="module")
def served():
    bench = _Bench()
    with Served(Starlette(routes=bench.routes)) as gateway:
        yield bench, gateway.url


@pytest.fixture
def bench(served):
    bench = served[0]
    bench.view = _running()
    bench.session = bench.sessions.open(Role.OPERATOR, "token")
    return bench


@pytest.fixture
def browser(served, bench):
    assert bench.session is not None
    with httpx.Client(base_url=served[1] + "/workspace") as client:
        yield client


@pytest.fixture
def desk(served, bench):
    assert bench.session is not None
    with connect(_address(served), proxy=None) as socket:
        yield socket


def _address(served):
    return f"{served[1]}/workspace/teleoperation".replace("http", "ws", 1)


def _read_to_the_end(desk):
    while True:
        desk.recv(timeout=PATIENCE)


def _say(desk, **message):
    desk.send(json.dumps(message))


@pytest.mark.parametrize("path", ["/state", "/example"])
def test_nothing_is_told_without_a_session(browser, bench, path):
    bench.session = None
    assert browser.get(path).status_code == 401


@pytest.mark.parametrize("path", ["/parameters", "/yaml"])
def test_a_viewer_reads_and_writes_no_yaml(browser, bench, path):
    bench.session = bench.sessions.open(Role.VIEWER, "token")

    assert browser.post(path, content=b"a: 1").status_code == 403


def bomb():
    """Return 470 bytes that mean 10 million values."""
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 7)]
    return "\n".join(lines).encode()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (bomb(), "makes more than 5000 values, with every alias written out"),
        (b"a: " + b"[" * 100 + b"]" * 100, "nested deeper than 64 levels"),
        (b"a: 1\n" * 50_000, "longer than the 32768 characters allowed"),
        (b"a: .inf", "JSON has finite numbers alone"),
        (b"a: 1\na: 2", "has the key 'a' twice"),
    ],
    ids=["aliases", "nesting", "length", "infinity", "twice"],
)
def test_a_text_that_would_cost_too_much_is_refused(browser, text, why):
    answer = browser.post("/parameters", content=text)

    assert (answer.status_code, answer.json()["code"]) == (422, "invalid_yaml")
    assert why in answer.json()["detail"]


@pytest.mark.parametrize(
    ("path", "body"), [("/parameters", b"a: 1"), ("/yaml", b'{"params": {"a": 1}}')]
)
def test_the_gateway_answers_while_yaml_is_read_or_written(
    browser, monkeypatch, path, body
):
    is_at_work, may_end = threading.Event(), threading.Event()

    def wait(*_args, **_kinds):
        is_at_work.set()
        assert may_end.wait(PATIENCE)
        raise ConfigError(["a is 1."], remedy="")

    monkeypatch.setattr(workspace_routes, "parse_yaml", wait)
    monkeypatch.setattr(workspace_routes, "_written", wait)
    asking = threading.Thread(
        target=lambda: httpx.post(f"{browser.base_url}{path[1:]}", content=body)
    )
    asking.start()
    assert is_at_work.wait(PATIENCE)
    try:
        assert browser.get("/state").status_code == 200
    finally:
        may_end.set()
        asking.join()


@pytest.mark.parametrize("path", ["/parameters", "/yaml"])
def test_nothing_is_done_without_a_session(browser, bench, path):
    bench.session = None
    assert browser.post(path).status_code == 401


def test_the_state_names_what_takes_values(browser):
    assert browser.get("/state").json()["operated"]["names"] == ["arm"]


def test_the_state_says_how_many_triangles_the_robots_have(browser):
    assert browser.get("/state").json()["triangles"] == 1500


def test_an_example_has_a_free_name_and_the_same_parameters_twice(browser):
    kind = "position_controllers/JointGroupPositionController"
    told = browser.get("/example", params={"type": kind}).json()
    assert told["params"] == {"joints": ["panda_joint1"]}
    read = browser.post("/parameters", content=told["yaml"].encode())
    assert read.json()["params"] == told["params"]


def test_parameters_are_the_same_in_yaml(browser):
    params = {"joint": "Gelenk é", "gains": {"p": 600, "limits": [0.1, 2]}, "on": True}
    text = browser.post("/yaml", json={"params": params}).json()["yaml"]
    assert "limits: [0.1, 2]" in text
    read = browser.post("/parameters", content=text.encode())
    assert read.json()["params"] == params
    assert browser.post("/yaml", json={"params": {}}).json() == {"yaml": ""}


@pytest.mark.parametrize("body", [[], {"params": [1]}, {"params": None}])
def test_what_are_no_parameters_has_no_yaml(browser, body):
    assert browser.post("/yaml", json=body).status_code == 422


@pytest.mark.parametrize("text", ["a: [", "- 1", "a: .nan", "1: a"])
def test_parameters_that_are_none_are_refused(browser, text):
    answer = browser.post("/parameters", content=text.encode())
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid_yaml")


def test_logging_out_ends_the_desk(desk, bench):
    _say(desk, do="jog", joint="joint1", sign=1)
    bench.sessions.close(bench.session.identifier)
    with pytest.raises(ConnectionClosed) as closed:
        _read_to_the_end(desk)
    assert closed.value.rcvd.code == 4401


def test_viewers_have_no_desk(served, bench):
    bench.session = bench.sessions.open(Role.VIEWER, "token")
    with (
        connect(_address(served), proxy=None) as socket,
        pytest.raises(ConnectionClosed) as closed,
    ):
        socket.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 4403
