"""The shapes of arms on the wire."""

from dataclasses import fields

import pytest
from pydantic import ValidationError

from station.core.franka import Frame, RobotState
from station.reports import described
from station.wire import FrankaState, JointImpedance, RecoveryRequest


def test_state_on_the_wire_has_every_field():
    assert set(FrankaState.model_fields) == {one.name for one in fields(RobotState)}


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
    other = {"robot_mode", "current_errors", "last_motion_errors"}

    assert set(wired) == set(FrankaState.model_fields)
    assert {k: v for k, v in wired.items() if k not in other} == {
        k: v for k, v in core.items() if k in wired and k not in other
    }
