"""Wire models of a gripper, and their defaults, which are those of the core."""

import pytest
from pydantic import ValidationError

from station.core.franka import DEFAULT_EPSILON, DEFAULT_SPEED
from station.wire import GraspEpsilon, GripperGraspRequest, GripperMoveRequest


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
