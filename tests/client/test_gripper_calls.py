"""The routes of a gripper as values."""

import json

from station.client import gripper_calls as calls
from station.wire import GripperGraspRequest


def test_names_are_quoted():
    assert calls.state("a/b").path == "/api/v1/robots/a%2Fb/gripper"


def test_a_grasp_is_sent_with_all_its_numbers():
    call = calls.grasp("panda", GripperGraspRequest(width=0.03, force=20.0))

    assert (call.method, call.path) == ("POST", "/api/v1/robots/panda/gripper/grasp")
    assert json.loads(call.body) == {
        "width": 0.03,
        "force": 20.0,
        "speed": 0.1,
        "epsilon": {"inner": 0.005, "outer": 0.005},
    }
