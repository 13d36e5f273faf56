"""A parallel gripper moves with the velocity and the effort of its goal."""

import pytest

from station.controllers.gripper_action_controller import (
    ParallelGripperActionController,
)
from station.core.errors import InvalidCommandError
from station.core.ports.goal import GoalStatus


@pytest.fixture
def start_parallel(robot):
    return lambda **values: robot.start(
        ParallelGripperActionController, joint="slide", **values
    )


def submit(controller, **command):
    return controller.goals.submit({"command": command})


def test_it_moves_with_the_velocity_of_the_goal(robot, start_parallel):
    controller = start_parallel()
    goal = submit(controller, position=[0.4], velocity=[0.5], effort=[3.0])
    robot.run_with_position(controller, 400)
    assert robot.position[0] == pytest.approx(0.2, abs=1e-9)

    robot.run_with_position(controller, 400)
    assert goal.status is GoalStatus.SUCCEEDED
    state = goal.result.details["state"]
    assert state["name"] == ["slide"]
    assert state["position"] == pytest.approx([0.39], abs=1e-3)
    assert goal.result.details["reached_goal"]


def test_the_velocity_of_the_parameters_holds_for_goals_without_one(
    robot, start_parallel
):
    controller = start_parallel(
        max_velocity=0.05, max_velocity_interface="slide/max_velocity"
    )
    submit(controller, position=[0.4])
    robot.run_with_position(controller, 1000)

    assert robot.position[0] == pytest.approx(0.05, abs=1e-9)


def test_without_an_interface_for_it_a_goal_has_no_velocity(robot, start_parallel):
    controller = start_parallel()
    submit(controller, position=[0.4])
    robot.run_with_position(controller, 1)

    assert controller.sample.output == [0.4]


@pytest.mark.parametrize(
    ("allows", "status"), [(True, GoalStatus.SUCCEEDED), (False, GoalStatus.ABORTED)]
)
def test_standing_still_elsewhere_succeeds_where_that_is_allowed(
    robot, start_parallel, allows, status
):
    controller = start_parallel(stall_timeout=0.1, allow_stalling=allows)
    goal = submit(controller, position=[0.4])
    robot.run_with_position(controller, 200, stuck=(0,))

    assert goal.status is status
    assert goal.result.details["stalled"]


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ({"position": 0.1}, "one number in a list"),
        ({"position": [0.1, 0.1]}, "one number in a list"),
        ({}, "command/position"),
        ({"position": [0.1], "velocity": [0.0]}, "command/velocity"),
        ({"position": [0.1], "name": ["elbow"]}, "command/name"),
        ({"position": [0.1], "max_effort": 3.0}, "max_effort"),
        ({"position": [0.6]}, "allowed is -0.5 to 0.5"),
    ],
)
def test_a_malformed_goal_is_refused(start_parallel, command, words):
    with pytest.raises(InvalidCommandError, match=words):
        submit(start_parallel(), **command)
