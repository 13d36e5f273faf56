"""The motion examples refuse to start away from their start pose."""

import pytest

from station.controllers.franka_example_controllers.start_pose import (
    START_POSE,
    check_start_pose,
)
from station.core.errors import ControllerStateError


def test_start_pose_is_accepted_within_its_tolerance():
    check_start_pose([q + 0.09 for q in START_POSE])
    with pytest.raises(ControllerStateError, match="Joint 7 is at"):
        check_start_pose([*START_POSE[:6], START_POSE[6] + 0.11])


def test_refusal_says_how_to_get_there():
    with pytest.raises(ControllerStateError) as caught:
        check_start_pose([0.0] * 7)

    way = caught.value.remedy.partition("TRAJECTORY_CONTROLLER ")[2]
    assert [float(q) for q in way.split()] == pytest.approx(START_POSE, abs=1e-5)
