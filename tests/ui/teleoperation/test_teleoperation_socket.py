"""The desk of one browser, over a real WebSocket."""

import asyncio
import json
import time
from dataclasses import replace
from itertools import pairwise

import pytest
from starlette.applications import Starlette
from starlette.routing import WebSocketRoute
from websockets.sync.client import connect

from station.client import ApiError
from station.ui.teleoperation import joint_teleoperation, teleoperation_socket
from station.ui.teleoperation.joint_teleoperation import Movers
from station.ui.teleoperation.teleoperation import SEND_PERIOD, Teleoperation
from station.ui.teleoperation.teleoperation_socket import TeleoperationSocket
from tests.ui.served import Served
from tests.ui.views import controller, element, sample, status, view
from tests.waiting import PATIENCE

NAMES = ("joint1", "joint2")
VIEW = view(
    controller("arm", "running", NAMES),
    elements={"arm": tuple(element(name) for name in NAMES)},
    samples={"arm": sample(1.0, desired=0.1, names=NAMES)},
)


class _Client:
    """Remembers the set-points of everybody, and refuses them on request."""

    def __init__(self):
        self.sent, self.sent_at = [], []
        self.takes = 0.0
        self.refusal = None
        self.lease = None
        self.view = VIEW
        self.movers = Movers()

    async def command(self, name, values, *, epoch):
        if self.refusal is not None:
            raise self.refusal
        self.sent.append((name, list(values), epoch))
        self.sent_at.append(time.monotonic())
        await asyncio.sleep(self.takes)


@pytest.fixture(scope="module")
def served():
    client = _Client()

    async def serve(socket):
        asked = Teleoperation(
            client, lambda: client.view, client.movers, lambda: client.lease
        )
        await TeleoperationSocket(socket, asked).run(asyncio.Event().wait)

    app = Starlette(routes=[WebSocketRoute("/desk", serve)])
    with Served(app) as server:
        yield client, f"{server.url}/desk".replace("http", "ws", 1)


@pytest.fixture
def client(served):
    served[0].__init__()
    return served[0]


@pytest.fixture
def desk(served, client):
    assert client.sent == []
    with connect(served[1], proxy=None) as socket:
        yield socket


def _say(desk, **message):
    desk.send(json.dumps(message))


def _hear(desk, wanted):
    """Return the first message of the desk that `wanted` accepts."""
    for _ in range(50):
        told = json.loads(desk.recv(timeout=PATIENCE))
        if wanted(told):
            return told
    pytest.fail("the desk does not say it")


def test_the_desk_moves_a_joint_to_a_typed_value(desk, client):
    _say(desk, do="speed", joints=1.5)
    _say(desk, do="go", targets={"joint1": 0.15})
    _hear(desk, lambda told: client.sent and told["remaining"] == 0.0)
    assert client.sent[-1] == ("arm", [0.15, None], 1)


def test_a_station_that_answers_slowly_does_not_slow_a_motion_down(desk, client):
    client.takes = 0.75 * SEND_PERIOD
    _say(desk, do="go", targets={"joint1": 0.6})
    _hear(desk, lambda told: client.sent and told["remaining"] == 0.0)
    gaps = [after - before for before, after in pairwise(client.sent_at)]
    # A busy machine makes some of them longer.
    assert min(gaps) < 1.5 * SEND_PERIOD
    assert sum(gaps) / len(gaps) > 0.9 * SEND_PERIOD


def test_a_held_button_stops_when_the_page_falls_silent(desk, client):
    _say(desk, do="jog", joint="joint2", sign=-1)
    _hear(desk, lambda told: told["remaining"] > 0.0)
    _hear(desk, lambda told: told["remaining"] == 0.0)
    assert 0.0 < 0.1 - client.sent[-1][1][1] < 0.5


def test_the_page_is_told_at_once_that_the_station_is_back(desk, client, monkeypatch):
    client.view = replace(VIEW, heard_at=None)
    assert _hear(desk, lambda told: told["link"] == "lost")
    # From now on nothing is told for its own sake.
    monkeypatch.setattr(teleoperation_socket, "_STATE_EVERY", 10**9)
    client.view = VIEW
    assert _hear(desk, lambda told: told["link"] == "live")


def test_a_refusal_of_the_station_ends_the_motion_and_is_told(desk, client):
    client.refusal = ApiError(
        "Somebody else has control.", status=423, code="held", remedy="Take control."
    )
    _say(desk, do="go", targets={"joint1": 0.9})
    told = _hear(desk, lambda told: "refused" in told)
    assert told["refused"] == "Somebody else has control."
    assert (told["code"], told["remedy"]) == ("held", "Take control.")
    assert _hear(desk, lambda told: "refused" not in told)["remaining"] == 0.0


def test_a_stop_ends_a_motion_without_a_reproach(desk, client):
    _say(desk, do="go", targets={"joint1": 0.9})
    assert _hear(desk, lambda told: told["remaining"] > 0.0)
    client.refusal = ApiError("The station is stopped.", status=409, code="stopped")
    told = []
    _hear(desk, lambda one: told.append(one) or one["remaining"] == 0.0)
    told.extend(json.loads(desk.recv(timeout=PATIENCE)) for _ in range(2))
    assert not any("refused" in one for one in told)


def test_a_motion_that_a_late_link_ends_is_told_of(desk, client):
    _say(desk, do="go", targets={"joint1": 0.9})
    assert _hear(desk, lambda told: told["remaining"] > 0.0)
    client.view = replace(VIEW, heard_at=VIEW.now - 1.0)
    told = _hear(desk, lambda told: "refused" in told)
    assert told["refused"] == "The link to the station was stale; the motion has ended."
    assert (told["code"], told["remedy"]) == (
        "link_interrupted",
        "Ask for the motion again.",
    )
    assert _hear(desk, lambda told: "refused" not in told)["remaining"] == 0.0
    client.view = VIEW
    later = [json.loads(desk.recv(timeout=PATIENCE)) for _ in range(2)]
    assert not any("refused" in one or one["remaining"] > 0.0 for one in later)


@pytest.mark.parametrize(
    "text", ["{}", "x", '{"do": "go", "targets": {"joint1": NaN}}', '{"do": "fly"}']
)
def test_what_is_not_understood_moves_nothing(desk, client, text):
    desk.send(text)
    _hear(desk, lambda told: "refused" in told)
    assert client.sent == []


@pytest.mark.usefixtures("client")
def test_two_browsers_do_not_share_a_motion(served, desk):
    with connect(served[1], proxy=None) as other:
        _say(desk, do="go", targets={"joint1": 0.9})
        assert _hear(desk, lambda told: told["remaining"] > 0.0)
        assert _hear(other, lambda told: "remaining" in told)["remaining"] == 0.0


@pytest.mark.usefixtures("client")
def test_whose_joint_another_browser_moves_is_told_so(served, desk):
    with connect(served[1], proxy=None) as other:
        _say(desk, do="go", targets={"joint1": 0.9, "joint2": 0.9})
        _hear(desk, lambda told: told["remaining"] > 0.0)
        _say(other, do="go", targets={"joint1": -0.9})
        told = _hear(desk, lambda told: "refused" in told)
        assert (told["code"], "joint1" in told["refused"]) == ("taken_over", True)
        assert _hear(desk, lambda told: "refused" not in told)["remaining"] > 0.0
        assert _hear(other, lambda told: told.get("remaining", 0.0) > 0.0)


@pytest.fixture
def held(monkeypatch):
    """Let a button count as held for long: the machine may be busy between messages."""
    monkeypatch.setattr(joint_teleoperation, "HELD_FOR", 60.0)


def _sent_while_held(desk, client, rounds):
    """Hold a button for some rounds of the desk; return how much was sent after one."""
    _say(desk, do="jog", joint="joint2", sign=-1)
    _hear(desk, lambda told: "remaining" in told)
    before = len(client.sent)
    for _ in range(rounds):
        _say(desk, do="jog", joint="joint2", sign=-1)
        _hear(desk, lambda told: "remaining" in told)
    return len(client.sent) - before


@pytest.mark.usefixtures("held")
def test_a_button_that_is_held_when_control_is_lost_has_to_be_pressed_anew(
    desk, client
):
    client.lease = "mine"
    assert _sent_while_held(desk, client, 1) > 0
    client.lease = None
    assert _sent_while_held(desk, client, 3) == 0
    _say(desk, do="release")
    _hear(desk, lambda told: "remaining" in told)
    _hear(desk, lambda told: "remaining" in told)
    assert _sent_while_held(desk, client, 2) > 0


@pytest.mark.usefixtures("held")
def test_a_button_that_is_held_during_a_reset_has_to_be_pressed_anew(desk, client):
    assert _sent_while_held(desk, client, 1) > 0
    client.view = replace(VIEW, status=status(epoch=2))
    _hear(desk, lambda told: "remaining" in told)
    assert _sent_while_held(desk, client, 3) == 0


@pytest.mark.usefixtures("held")
def test_a_button_that_is_held_while_the_robot_is_stopped_does_not_move_it_later(
    desk, client
):
    client.view = replace(VIEW, status=status("stopped"))
    assert _sent_while_held(desk, client, 1) == 0
    client.view = VIEW
    assert _sent_while_held(desk, client, 3) == 0


@pytest.mark.usefixtures("held")
def test_a_button_that_is_held_is_refused_once(desk, client):
    client.refusal = ApiError("Ada holds control.", status=423, code="control_held")
    _say(desk, do="jog", joint="joint2", sign=-1)
    _hear(desk, lambda told: "refused" in told)
    client.refusal = None
    assert _sent_while_held(desk, client, 3) == 0
