"""What streaming and jogging share."""

import pytest

from station.controllers.smoothed_motion import (
    PositionJointJogController,
    PositionJointStreamingController,
)
from station.core.errors import ParameterError, RobotDescriptionError
from tests.controllers.smoothed_motion.conftest import JOINTS, LIMITS

BOTH = pytest.mark.parametrize(
    "kind", [PositionJointJogController, PositionJointStreamingController]
)


@BOTH
def test_a_start_in_motion_neither_jumps_nor_jerks(robot, kind):
    robot.position[:] = [0.1, 0.2, 0.0]
    robot.velocity[:] = [0.2, -1.0, 0.0]
    controller = robot.start(kind, **LIMITS)
    robot.step(controller)

    assert robot.positions_commanded[:2] == pytest.approx([0.1002, 0.199], abs=1e-5)
    robot.step(controller, 1_500)
    held = list(robot.positions_commanded)
    robot.step(controller, 100)
    assert robot.positions_commanded == held


@BOTH
@pytest.mark.parametrize(
    "values",
    [
        {"command_timeout": 0.0},
        {"command_timeout": 1.5},
        {"command_timeout": -1.0},
        {"command_timeout_action": "off"},
        {"max_velocity": 3.0},
        {"joints": []},
    ],
)
def test_impossible_parameters_are_refused(robot, kind, values):
    with pytest.raises(ParameterError):
        robot.load(kind, **(LIMITS | values))


@BOTH
def test_smoothed_motion_needs_a_robot_description(make_robot, kind):
    with pytest.raises(RobotDescriptionError):
        make_robot(JOINTS, "").load(kind, joints=JOINTS)


@BOTH
def test_the_desired_positions_of_a_sample_are_the_smoothed_ones(robot, kind):
    controller = robot.start(kind, **LIMITS)
    robot.step(controller)

    sample = controller.sample
    assert sample.desired == sample.output == [0.0, 0.0]
    assert sample.actual == sample.error == [0.0, 0.0]


@pytest.mark.parametrize(
    "kind", [PositionJointJogController, PositionJointStreamingController]
)
def test_smoothed_motion_claims_its_joints_for_position_commands(robot, kind):
    (claim,) = robot.load(kind, **LIMITS).claims

    assert claim.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claim.resources == ("elbow", "slide")
