"""One method per route of a gripper."""

import pytest

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
