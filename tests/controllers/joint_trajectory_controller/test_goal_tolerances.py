"""Bounds of a goal's errors on its path and at its end, and the time to get there."""

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import GoalStatus

AWAY = (1.0, [0.1, 0.5, -0.5])
TOLERANCES = {
    "constraints": {
        "goal_time": 0.5,
        "elbow": {"trajectory": 0.05, "goal": 0.01},
        "wheel": {"trajectory": 0.05, "goal": 0.01},
    }
}


def test_a_violated_path_tolerance_aborts_and_holds(robot, start, make_goal):
    controller = start(**TOLERANCES)
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500, stuck=[1])
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.code == -4
    assert goal.result.message.startswith("Joint 'elbow' has a position error of 0.05")
    details = goal.result.details
    assert details["joint"] == "elbow"
    assert details["error"] > details["tolerance"] == 0.05
    assert details["time"] == pytest.approx(0.1, abs=0.002)
    here = list(robot.position)
    robot.run_with_position(controller, 1000)
    assert robot.position == pytest.approx(here, abs=1e-12)


@pytest.mark.parametrize("key", ["path_tolerance", "goal_tolerance"])
def test_a_tolerance_of_acceleration_is_refused_by_name(start, make_goal, key):
    controller = start(**TOLERANCES)
    bounds = [{"name": "elbow", "acceleration": 0.5}]

    with pytest.raises(InvalidTrajectoryError, match=r"acceleration.*elbow") as caught:
        controller.goals.submit(make_goal(AWAY, **{key: bounds}))
    assert caught.value.details["error_code"] == -1

    # What ROS programs send when they ask for nothing: the default, and no bound.
    for nothing in (0.0, -1.0):
        bounds[0]["acceleration"] = nothing
        controller.goals.submit(make_goal(AWAY, **{key: bounds}))


def test_a_violated_goal_tolerance_aborts_after_the_goal_time(robot, start, make_goal):
    controller = start(**TOLERANCES)
    goal = controller.goals.submit(
        make_goal(AWAY, path_tolerance=[{"name": "wheel", "position": -1.0}])
    )
    robot.run_with_position(controller, 1490, stuck=[2])
    assert goal.status is GoalStatus.ACTIVE
    robot.run_with_position(controller, 20, stuck=[2])
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.code == -5
    assert "Joint 'wheel' has a position error of -0.5 rad at its goal" in (
        goal.result.message
    )


def test_a_joint_that_arrives_late_but_in_time_succeeds(robot, start, make_goal):
    controller = start(**TOLERANCES)
    goal = controller.goals.submit(
        make_goal(AWAY, path_tolerance=[{"name": "elbow", "position": -1.0}])
    )
    robot.run_with_position(controller, 1200, stuck=[1])
    assert goal.status is GoalStatus.ACTIVE
    robot.run_with_position(controller, 3)
    assert goal.status is GoalStatus.SUCCEEDED


def test_without_tolerances_a_stuck_joint_is_no_reason_to_abort(
    robot, start, make_goal
):
    controller = start(constraints={"stopped_velocity_tolerance": 0.0})
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 1010, stuck=[0, 1, 2])
    assert goal.status is GoalStatus.SUCCEEDED
