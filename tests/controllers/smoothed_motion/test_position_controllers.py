"""Smoothed motion by position commands."""

import pytest

from station.controllers.smoothed_motion.position_controllers import (
    JointJogController,
    JointStreamingController,
)
from tests.controllers.smoothed_motion.conftest import LIMITS


@pytest.mark.parametrize("kind", [JointJogController, JointStreamingController])
def test_it_claims_its_joints_for_position_commands(robot, kind):
    (claim,) = robot.load(kind, **LIMITS).claims

    assert claim.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claim.resources == ("elbow", "slide")
