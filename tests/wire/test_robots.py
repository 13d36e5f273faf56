"""Wire models of robots, grippers and their hardware."""

import json
from dataclasses import fields

import pytest
from pydantic import ValidationError

from station.core.franka import DEFAULT_EPSILON, DEFAULT_SPEED, Frame, RobotState
from station.reports import described, examples_of
from station.wire import (
    FrankaState,
    GraspEpsilon,
    GripperGraspRequest,
    GripperMoveRequest,
    Hardware,
    JointImpedance,
    RecoveryRequest,
)
from station.wire.base import reader_of

_OF_THE_SCENE = {"least_clearance", "nearest_pair"}


def test_state_on_the_wire_has_every_field():
    assert set(FrankaState.model_fields) - _OF_THE_SCENE == {
        one.name for one in fields(RobotState)
    }


def test_arrays_have_their_length():
    with pytest.raises(ValidationError, match="at least 7"):
        JointImpedance(joint_stiffness=[1.0] * 6)


def test_nothing_restarts_unless_asked_for():
    assert RecoveryRequest().restart == "none"


def test_every_frame_has_its_name():
    assert {frame.name.lower() for frame in Frame} == {
        *(f"joint{number}" for number in range(1, 8)),
        "flange",
        "end_effector",
        "stiffness",
    }


def test_the_state_of_an_arm_is_described_as_in_the_core():
    core, wired = described(RobotState.__doc__)[1], described(FrankaState.__doc__)[1]
    other = {"robot_mode", "current_errors", "last_motion_errors", *_OF_THE_SCENE}

    assert set(wired) == set(FrankaState.model_fields)
    assert {k: v for k, v in wired.items() if k not in other} == {
        k: v for k, v in core.items() if k in wired and k not in other
    }


def test_defaults_are_those_of_the_core():
    grasp = GripperGraspRequest(width=0.03, force=20.0)

    assert grasp.speed == GripperMoveRequest(width=0.0).speed == DEFAULT_SPEED
    assert grasp.epsilon == GraspEpsilon(inner=DEFAULT_EPSILON, outer=DEFAULT_EPSILON)


@pytest.mark.parametrize(
    "wrong", [{"width": -0.1}, {"speed": 0.0}, {"force": 0.0}, {"epsilon": {"in": 1.0}}]
)
def test_impossible_grasps_are_refused(wrong):
    with pytest.raises(ValidationError):
        GripperGraspRequest.model_validate({"width": 0.03, "force": 20.0, **wrong})


def test_the_example_is_valid():
    (example,) = examples_of(Hardware.__doc__)

    hardware = reader_of(Hardware).validate_json(json.dumps(example))

    assert hardware.model_dump(mode="json") == example
