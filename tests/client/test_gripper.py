"""One method per route of a gripper."""

import asyncio
import json

import httpx
import pytest

from station.client import AsyncStationClient, MotionError, robots
from station.wire import GripperGraspRequest, GripperMoveRequest
from tests.client.recorder import Recorder

STATE = {
    "arm_id": "panda",
    "width": 0.08,
    "max_width": 0.08,
    "is_grasped": False,
    "temperature": 20.0,
    "time": 1.0,
    "activity": "idle",
    "force": 0.0,
    "command": None,
    "last": None,
}
REQUESTS = [
    ("state", (), "GET", "", None),
    ("homing", (), "POST", "/homing", None),
    ("move", (GripperMoveRequest(width=0.03),), "POST", "/move", {"width": 0.03}),
    (
        "grasp",
        (GripperGraspRequest(width=0.03, force=20.0),),
        "POST",
        "/grasp",
        {"width": 0.03, "force": 20.0},
    ),
    ("stop", (), "POST", "/stop", None),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest", "body"), REQUESTS)
def test_every_method_asks_its_route(name, arguments, method, rest, body):
    recorder = Recorder(STATE)

    found = recorder.run(
        lambda client: getattr(client.robot("panda").gripper, name)(*arguments)
    )

    assert found.activity == "idle"
    path = f"/api/v1/robots/panda/gripper{rest}"
    assert recorder.requests == [(method, path, body)]


class Hand:
    """A hand whose last command ends after two looks at it."""

    def __init__(self, status, message=""):
        self.requests = []
        self._looks = 0
        self._last = {**COMMAND, "status": status, "message": message, "ended": 2.0}

    def answer(self, request):
        """Answer a request."""
        begins = request.method == "POST"
        if begins:
            self.requests.append((request.url.path, json.loads(request.content)))
        self._looks += bool(self.requests)
        is_over = self._looks > 2
        command = COMMAND if self.requests and not is_over else None
        state = {**STATE, "command": command, "last": self._last if is_over else None}
        return httpx.Response(200, json=state)

    def run(self, ask):
        """Return what `ask` returns when given the gripper."""

        async def run():
            transport = httpx.MockTransport(self.answer)
            async with AsyncStationClient(
                "http://a", "t", transport=transport
            ) as client:
                return await ask(client.robot().gripper)

        return asyncio.run(run())


COMMAND = {
    "id": "1",
    "action": "grasp",
    "status": "active",
    "message": "",
    "request": {},
    "started": 1.0,
    "ended": None,
}


@pytest.fixture
def no_waiting(monkeypatch):
    """Let waiting pass at once."""
    monkeypatch.setattr(robots, "POLL", 0.0)


@pytest.mark.usefixtures("no_waiting")
def test_gripper_opens_all_the_way_in_one_line():
    hand = Hand("succeeded")

    state = hand.run(lambda gripper: gripper.open())

    assert state.last.status == "succeeded"
    path = "/api/v1/robots/panda/gripper/move"
    assert hand.requests == [(path, {"width": 0.08, "speed": 0.1})]


@pytest.mark.usefixtures("no_waiting")
def test_gripper_closes_on_whatever_is_there_in_one_line():
    hand = Hand("succeeded")

    hand.run(lambda gripper: gripper.close(force=5.0))

    ((path, body),) = hand.requests
    assert path.endswith("/grasp")
    assert (body["width"], body["force"]) == (0.0, 5.0)
    assert body["epsilon"] == {"inner": 0.005, "outer": 0.08}


@pytest.mark.usefixtures("no_waiting")
def test_gripper_that_does_not_succeed_is_an_error():
    hand = Hand("aborted", "The fingers are blocked.")

    with pytest.raises(MotionError, match="The fingers are blocked"):
        hand.run(lambda gripper: gripper.open(0.02))


def test_gripper_that_takes_too_long_is_given_up():
    hand = Hand("succeeded")

    with pytest.raises(MotionError, match="more than -1 s"):
        hand.run(lambda gripper: gripper.open(timeout=-1))
