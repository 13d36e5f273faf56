"""Hands on the wire and back."""

import math
from dataclasses import replace

import pytest

from station.api import gripper_wire as wire
from station.core.franka import (
    GraspRequest,
    GripperAction,
    GripperActivity,
    GripperCommand,
    GripperState,
)
from station.core.ports.goal import GoalStatus
from station.wire import GraspEpsilon, GripperGraspRequest

IDLE = GripperState(
    width=0.08,
    max_width=0.08,
    is_grasped=False,
    temperature=20.0,
    time=1.0,
    activity=GripperActivity.IDLE,
    force=0.0,
    command=None,
    last=None,
)


@pytest.mark.parametrize("activity", GripperActivity)
def test_every_activity_has_its_name(activity):
    found = wire.gripper("panda", replace(IDLE, activity=activity, force=math.nan))

    assert (found.activity, found.force) == (activity.value, None)


@pytest.mark.parametrize("action", GripperAction)
@pytest.mark.parametrize("status", list(GoalStatus)[1:])
def test_every_command_that_has_begun_can_be_told(action, status):
    command = GripperCommand(3, action, status, "why", {"width": 0.1}, 1.0, 2.0)

    found = wire.gripper("panda", replace(IDLE, last=command)).last

    assert (found.id, found.action, found.status) == ("3", action.value, status.value)
    assert (found.request, found.message) == ({"width": 0.1}, "why")


def test_a_grasp_comes_back_as_it_was_asked_for():
    epsilon = GraspEpsilon(inner=0.001, outer=0.002)
    request = GripperGraspRequest(width=0.03, force=9.0, speed=0.05, epsilon=epsilon)

    assert wire.grasp_request(request) == GraspRequest(0.03, 9.0, 0.05, 0.001, 0.002)
