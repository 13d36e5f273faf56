"""Requests that the gateway answers itself, and the desk of one browser."""

import json

import httpx
import pytest
from starlette.applications import Starlette
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.client import ApiError
from station.ui.sessions import Role, Sessions
from station.ui.workspace_routes import WorkspaceParts, WorkspaceRoutes
from tests.ui.served import Served
from tests.ui.views import controller, element, sample, view

NAMES = ("joint1", "joint2")
_PATIENCE = 5.0


class _Client:
    """Remembers the set-points of everybody, and refuses them on request."""

    def __init__(self):
        self.sent = []
        self.refusal = None

    async def __aenter__(self):
        return self

    async def __aexit__(self, *_):
        return None

    async def command(self, name, values, *, epoch):
        if self.refusal is not None:
            raise self.refusal
        self.sent.append((name, list(values), epoch))


class _Bench:
    """The workspace's routes, without the gateway before them."""

    def __init__(self):
        self.client = _Client()
        self.sessions = Sessions()
        self.session = None
        self.view = _running()
        parts = WorkspaceParts(lambda: self.view, lambda _: self.client)
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
    bench.client.sent.clear()
    bench.client.refusal = None
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


def _say(desk, **message):
    desk.send(json.dumps(message))


def _hear(desk, wanted):
    """Return the first message of the desk that `wanted` accepts."""
    for _ in range(50):
        told = json.loads(desk.recv(timeout=_PATIENCE))
        if wanted(told):
            return told
    pytest.fail("the desk does not say it")


@pytest.mark.parametrize("path", ["/state", "/example"])
def test_nothing_is_told_without_a_session(browser, bench, path):
    bench.session = None
    assert browser.get(path).status_code == 401


@pytest.mark.parametrize("path", ["/parameters", "/bench"])
def test_nothing_is_done_without_a_session(browser, bench, path):
    bench.session = None
    assert browser.post(path).status_code == 401


def test_the_state_names_what_takes_values(browser):
    assert browser.get("/state").json()["operated"]["name"] == "arm"


def test_an_example_has_a_free_name_and_the_same_parameters_twice(browser):
    kind = "position_controllers/JointGroupPositionController"
    told = browser.get("/example", params={"type": kind}).json()
    assert told["params"] == {"joints": ["panda_joint1"]}
    read = browser.post("/parameters", content=told["yaml"].encode())
    assert read.json()["params"] == told["params"]


@pytest.mark.parametrize("text", ["a: [", "- 1", "a: .nan", "a: 2026-11-22"])
def test_parameters_that_are_none_are_refused(browser, text):
    answer = browser.post("/parameters", content=text.encode())
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid_yaml")


def test_the_bench_refuses_what_leaves_the_envelope(browser, bench):
    answer = browser.post("/bench", json={"joint": "joint1", "size": 0.9})
    assert answer.status_code == 422
    answer = browser.post("/bench", json={"joint": "elbow"})
    assert (answer.status_code, answer.json()["code"]) == (409, "bench_refused")
    bench.session = bench.sessions.open(Role.VIEWER, "token")
    assert browser.post("/bench", json={"joint": "joint1"}).status_code == 403


def test_the_desk_moves_a_joint_to_a_typed_value(desk, bench):
    _say(desk, do="speed", joints=1.5)
    _say(desk, do="go", targets={"joint1": 0.15})
    _hear(desk, lambda told: bench.client.sent and told["remaining"] == 0.0)
    assert bench.client.sent[-1] == ("arm", [0.15, 0.1], 1)


def test_a_held_button_stops_when_the_page_falls_silent(desk, bench):
    _say(desk, do="jog", joint="joint2", sign=-1)
    _hear(desk, lambda told: told["remaining"] > 0.0)
    _hear(desk, lambda told: told["remaining"] == 0.0)
    assert 0.0 < 0.1 - bench.client.sent[-1][1][1] < 0.5


def test_a_refusal_of_the_station_ends_the_motion_and_is_told(desk, bench):
    bench.client.refusal = ApiError(
        "Somebody else has control.", status=423, code="held", remedy="Take control."
    )
    _say(desk, do="go", targets={"joint1": 0.9})
    told = _hear(desk, lambda told: "refused" in told)
    assert told["refused"] == "Somebody else has control."
    assert (told["code"], told["remedy"]) == ("held", "Take control.")
    assert _hear(desk, lambda told: "refused" not in told)["remaining"] == 0.0


@pytest.mark.parametrize(
    "text", ["{}", "x", '{"do": "go", "targets": {"joint1": NaN}}', '{"do": "fly"}']
)
def test_what_is_not_understood_moves_nothing(desk, bench, text):
    desk.send(text)
    _hear(desk, lambda told: "refused" in told)
    assert bench.client.sent == []


def test_logging_out_ends_the_desk(desk, bench):
    _say(desk, do="jog", joint="joint1", sign=1)
    bench.sessions.close(bench.session.identifier)
    with pytest.raises(ConnectionClosed) as closed:
        _hear(desk, lambda _: False)
    assert closed.value.rcvd.code == 4401


def test_viewers_have_no_desk(served, bench):
    bench.session = bench.sessions.open(Role.VIEWER, "token")
    with (
        connect(_address(served), proxy=None) as socket,
        pytest.raises(ConnectionClosed) as closed,
    ):
        socket.recv(timeout=_PATIENCE)
    assert closed.value.rcvd.code == 4403


def test_two_browsers_do_not_share_a_motion(served, desk):
    with connect(_address(served), proxy=None) as other:
        _say(desk, do="go", targets={"joint1": 0.9})
        assert _hear(desk, lambda told: told["remaining"] > 0.0)
        assert _hear(other, lambda told: "remaining" in told)["remaining"] == 0.0
