"""The gripper that commands efforts."""

import pytest

from station.controllers.gripper_action_controller import (
    EffortGripperActionController,
)
from station.core.errors import ParameterError
from station.core.ports.goal import GoalStatus

GAINS = {"gains": {"slide": {"p": 200.0, "d": 20.0, "i": 0.0}}}


@pytest.fixture
def gripper(robot):
    return robot.start(EffortGripperActionController, joint="slide", **GAINS)


def test_the_effort_gripper_commands_no_effort_after_the_start(robot, gripper):
    robot.position[0] = 0.0
    robot.step(gripper, 5)

    assert robot.efforts_commanded[0] == 0.0


def test_the_effort_gripper_moves_a_mass_to_its_goal(robot, gripper, submit):
    goal = submit(gripper, 0.3, max_effort=20.0)

    robot.run_with_effort(gripper, 1_500)

    assert goal.status is GoalStatus.SUCCEEDED
    assert robot.position[0] == pytest.approx(0.3, abs=1e-3)


@pytest.mark.parametrize("limit", [0.0, 3.0])
def test_the_effort_stays_within_that_of_the_goal(robot, gripper, submit, limit):
    submit(gripper, 0.3, max_effort=limit)
    robot.step(gripper)
    assert robot.efforts_commanded[0] == limit
    assert gripper.sample.output == [limit]
    submit(gripper, -0.3, max_effort=limit)
    robot.step(gripper)
    assert robot.efforts_commanded[0] == -limit


def test_gains_of_the_effort_gripper_change_by_name(robot, gripper, submit):
    values = gripper.tunables.values | {"slide/p": 100.0}
    assert set(gripper.tunables.schema) == set(values)
    gripper.tunables.apply(gripper.tunables.checked(values))
    submit(gripper, 0.3)
    robot.step(gripper)

    assert robot.efforts_commanded[0] == pytest.approx(30.0)


def test_the_effort_gripper_requires_gains(robot):
    with pytest.raises(ParameterError, match="slide"):
        robot.load(EffortGripperActionController, joint="slide")
