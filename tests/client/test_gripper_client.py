"""One method per route of a gripper."""

import pytest

from station.client.robot_client import RobotClient
from station.wire import GripperGraspRequest, GripperMoveRequest

CALLS = [
    ("state", (), "GET", ""),
    ("homing", (), "POST", "/homing"),
    ("move", (GripperMoveRequest(width=0.03),), "POST", "/move"),
    ("grasp", (GripperGraspRequest(width=0.03, force=20.0),), "POST", "/grasp"),
    ("stop", (), "POST", "/stop"),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest"), CALLS)
def test_method_asks_its_route(name, arguments, method, rest):
    sent = []

    getattr(RobotClient(sent.append, "panda").gripper, name)(*arguments)

    (call,) = sent
    assert (call.method, call.path) == (method, f"/api/v1/robots/panda/gripper{rest}")
