"""Smoothed motion by effort commands."""

import pytest

from station.controllers.smoothed_motion.effort_controllers import (
    JointJogController,
    JointStreamingController,
)
from station.core.errors import ParameterError
from tests.controllers.smoothed_motion.conftest import LIMITS

GAINS = {"gains": {name: {"p": 900.0, "d": 60.0} for name in LIMITS["joints"]}}


def test_unit_masses_follow_the_stream(robot, send):
    controller = robot.start(JointStreamingController, **LIMITS, **GAINS)
    for _ in range(30):
        send(controller, [0.3, -0.8])
        robot.run_with_effort(controller, 100)

    assert robot.position[:2] == pytest.approx([0.3, -0.8], abs=1e-3)


def test_unit_masses_are_jogged(robot, send):
    controller = robot.start(JointJogController, **LIMITS, **GAINS)
    for _ in range(10):
        send(controller, [0.2, -0.5])
        robot.run_with_effort(controller, 100)

    assert robot.velocity[:2] == pytest.approx([0.2, -0.5], abs=0.02)


def test_starting_commands_nothing(robot):
    controller = robot.start(JointStreamingController, **LIMITS, **GAINS)
    robot.step(controller, 3)

    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_gains_are_required_and_can_be_changed(robot):
    with pytest.raises(ParameterError, match="slide"):
        robot.load(JointJogController, **LIMITS)
    controller = robot.load(JointJogController, **LIMITS, **GAINS)
    values = controller.gains() | {"slide/p": 10.0}
    controller.check_gains(values)
    controller.apply_gains(values)

    assert controller.gains()["slide/p"] == 10.0
    assert set(controller.gain_schema()) == set(values)
