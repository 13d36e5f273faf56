"""Requests that the gateway answers itself, and the desk of one browser."""

import json

import httpx
import pytest
from starlette.applications import Starlette
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.ui.sessions import Role, Sessions
from station.ui.workspace_routes import WorkspaceParts, WorkspaceRoutes
from tests.ui.served import Served
from tests.ui.views import controller, element, sample, view

NAMES = ("joint1", "joint2")
_PATIENCE = 5.0


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
    return f"{served[1]}/workspace/desk".replace("http", "ws", 1)


def _read_to_the_end(desk):
    while True:
        desk.recv(timeout=_PATIENCE)


def _say(desk, **message):
    desk.send(json.dumps(message))


@pytest.mark.parametrize("path", ["/state", "/example"])
def test_nothing_is_told_without_a_session(browser, bench, path):
    bench.session = None
    assert browser.get(path).status_code == 401


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


@pytest.mark.parametrize("text", ["a: [", "- 1", "a: .nan", "a: 2026-11-22"])
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
        socket.recv(timeout=_PATIENCE)
    assert closed.value.rcvd.code == 4403
