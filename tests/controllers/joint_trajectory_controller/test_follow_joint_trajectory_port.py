"""The port of goals: names, the list, and tolerances of a goal."""

import pytest

from station.core.errors import GoalNotFoundError, InvalidTrajectoryError
from station.core.ports.goal import GoalStatus

AWAY = (1.0, [0.1, 0.5, -0.5])


def test_accepted_goals_are_listed_and_refused_goals_are_not(start, make_goal):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    with pytest.raises(InvalidTrajectoryError):
        controller.goals.submit(make_goal((1.0, [0.0])))
    assert controller.goals.goals() == [goal]
    assert controller.goals.get(goal.identifier) is goal
    with pytest.raises(GoalNotFoundError):
        controller.goals.get("none")


def test_a_goal_waits_for_the_next_cycle(robot, start, make_goal):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    assert goal.status is GoalStatus.PENDING
    robot.run_with_position(controller, 1)
    assert goal.status is GoalStatus.ACTIVE


def test_a_goal_can_tighten_and_loosen_the_default_tolerances(robot, start, make_goal):
    controller = start(constraints={"elbow": {"trajectory": 0.05}})
    loose = controller.goals.submit(
        make_goal(AWAY, path_tolerance=[{"name": "elbow", "position": -1.0}])
    )
    robot.run_with_position(controller, 500, stuck=[1])
    assert loose.status is GoalStatus.ACTIVE
    tight = controller.goals.submit(
        make_goal(AWAY, path_tolerance=[{"name": "elbow", "position": 0.001}])
    )
    robot.run_with_position(controller, 500, stuck=[1])
    assert loose.status is GoalStatus.PREEMPTED
    assert tight.status is GoalStatus.ABORTED
    assert tight.result.details["tolerance"] == 0.001


def test_a_goal_that_was_cancelled_before_it_began_ends_at_once(
    robot, start, make_goal
):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    controller.goals.cancel(goal.identifier)
    robot.run_with_position(controller, 100)
    assert goal.status is GoalStatus.PREEMPTED
    assert robot.position == [0.0, 0.0, 0.0]


def test_voiding_ends_goals_and_trajectories_for_good(robot, start, make_goal):
    controller = start()
    begun = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 300)
    waiting = controller.goals.submit(make_goal(AWAY))
    here = list(robot.position)

    controller.goals.void("A reset.")
    robot.run_with_position(controller, 1500)

    for goal in (begun, waiting):
        assert goal.status is GoalStatus.PREEMPTED
        assert goal.result.message == "A reset."
    assert robot.position == pytest.approx(here, abs=1e-12)
