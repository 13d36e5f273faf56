"""Smoothed motion by effort commands."""

import pytest

from station.controllers.smoothed_motion import (
    EffortJointJogController,
    EffortJointStreamingController,
)
from station.core.errors import ParameterError
from tests.controllers.smoothed_motion.conftest import LIMITS

GAINS = {"gains": {name: {"p": 900.0, "d": 60.0} for name in LIMITS["joints"]}}


def test_unit_masses_follow_the_stream(robot, send):
    controller = robot.start(EffortJointStreamingController, **LIMITS, **GAINS)
    for _ in range(30):
        send(controller, [0.3, -0.8])
        robot.run_with_effort(controller, 100)

    assert robot.position[:2] == pytest.approx([0.3, -0.8], abs=1e-3)


def test_unit_masses_are_jogged(robot, send):
    controller = robot.start(EffortJointJogController, **LIMITS, **GAINS)
    for _ in range(10):
        send(controller, [0.2, -0.5])
        robot.run_with_effort(controller, 100)

    assert robot.velocity[:2] == pytest.approx([0.2, -0.5], abs=0.02)


def test_starting_commands_nothing(robot):
    controller = robot.start(EffortJointStreamingController, **LIMITS, **GAINS)
    robot.step(controller, 3)

    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_gains_are_required_and_can_be_changed(robot):
    with pytest.raises(ParameterError, match="slide"):
        robot.load(EffortJointJogController, **LIMITS)
    controller = robot.load(EffortJointJogController, **LIMITS, **GAINS)
    values = controller.tunables.values | {"slide/p": 10.0}
    controller.tunables.apply(controller.tunables.checked(values))

    assert controller.tunables.values["slide/p"] == 10.0
    assert set(controller.tunables.schema) == set(values)


def run_with_wall(robot, controller, cycles, wall):
    """Run with the slide kept below `wall` [m]; return its largest lead."""
    largest = 0.0
    for _ in range(cycles):
        robot.run_with_effort(controller, 1)
        if robot.position[0] > wall:
            robot.position[0], robot.velocity[0] = wall, 0.0
        lead = controller.sample.desired[0] - controller.sample.actual[0]
        largest = max(largest, abs(lead))
    return largest


@pytest.mark.parametrize(
    ("kind", "command"),
    [
        (EffortJointStreamingController, [0.45, 0.0]),
        (EffortJointJogController, [0.3, 0.0]),
    ],
)
def test_a_blocked_joint_is_waited_for_and_makes_no_leap(robot, send, kind, command):
    controller = robot.start(kind, **LIMITS, **GAINS, max_lead=0.03)
    largest = 0.0
    for _ in range(30):
        send(controller, command)
        largest = max(largest, run_with_wall(robot, controller, 100, wall=0.1))
    # Beyond the bound by the way to rest at most: v^2 / (2 a) + v a / (2 j).
    assert largest <= 0.03 + 0.5**2 / 4.0 + 0.5 * 2.0 / 80.0 + 1e-3
    waiting = controller.generator.positions[0]
    assert waiting < 0.25
    fastest = 0.0
    for _ in range(20):  # free again
        send(controller, command)
        robot.run_with_effort(controller, 100)
        fastest = max(fastest, abs(robot.velocity[0]))

    assert robot.position[0] > waiting + 0.1
    assert fastest < 2.5  # the spring of the lead alone, sqrt(900) * 0.1


def test_a_blocked_joint_can_be_led_back(robot, send):
    controller = robot.start(EffortJointJogController, **LIMITS, **GAINS, max_lead=0.03)
    for _ in range(10):
        send(controller, [0.3, 0.0])
        run_with_wall(robot, controller, 100, wall=0.05)
    for _ in range(5):
        send(controller, [-0.3, 0.0])
        run_with_wall(robot, controller, 100, wall=0.05)

    assert robot.position[0] < 0.03


@pytest.mark.parametrize("lead", [0.0, [0.1], -1.0])
def test_an_impossible_lead_is_refused(robot, lead):
    with pytest.raises(ParameterError, match="max_lead"):
        robot.load(EffortJointJogController, **LIMITS, **GAINS, max_lead=lead)
