"""What the examples share."""

import pytest

from station.controllers.franka_example_controllers.start_pose import (
    START_POSE,
    check_start_pose,
    read_arm_id,
    read_joint_names,
)
from station.core.errors import ControllerStateError, ParameterError
from station.core.parameters import Parameters, ParameterTree


def test_start_pose_is_accepted_within_its_tolerance():
    check_start_pose([q + 0.09 for q in START_POSE])
    with pytest.raises(ControllerStateError, match="joint 7 is at"):
        check_start_pose([*START_POSE[:6], START_POSE[6] + 0.11])


def test_refusal_says_how_to_get_there():
    with pytest.raises(ControllerStateError) as caught:
        check_start_pose([0.0] * 7)

    way = caught.value.remedy.partition("TRAJECTORY_CONTROLLER ")[2]
    assert [float(q) for q in way.split()] == pytest.approx(START_POSE, abs=1e-5)


def test_names_are_required():
    params = Parameters(ParameterTree({"joint_names": ["a"]}))
    with pytest.raises(ParameterError, match="must name 7"):
        read_joint_names(params)
    with pytest.raises(ParameterError, match="arm_id"):
        read_arm_id(params)
