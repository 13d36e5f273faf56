"""Opening, closing, stalling, and what ends a goal."""

import pytest

from station.core.errors import ParameterError, RobotDescriptionError
from station.core.ports.goal import GoalStatus

URDF_WITHOUT_EFFORT = """
<robot name="fake"><joint name="slide" type="continuous"/></robot>
"""


def test_starting_stays_where_the_finger_is(robot, start):
    robot.position[0] = 0.3
    controller = start()

    robot.run_with_position(controller, 3)

    assert robot.positions_commanded[0] == 0.3
    assert controller.sample.desired == [0.3]
    assert controller.sample.error == [0.0]


def test_a_goal_succeeds_within_its_tolerance(robot, start, submit):
    controller = start(goal_tolerance=0.02)
    goal = submit(controller, 0.4)
    assert goal.status is GoalStatus.PENDING
    robot.step(controller)
    assert goal.status is GoalStatus.ACTIVE
    robot.position[0] = 0.2
    robot.step(controller)
    assert goal.progress == pytest.approx(0.5)

    robot.position[0] = 0.39
    robot.effort[0] = 7.0
    robot.step(controller)

    assert goal.status is GoalStatus.SUCCEEDED
    assert goal.progress == 1.0
    assert goal.result.message == ""
    assert goal.result.details == {
        "position": 0.39,
        "effort": 7.0,
        "stalled": False,
        "reached_goal": True,
    }


def test_standing_still_elsewhere_aborts_and_goes_on_pressing(robot, start, submit):
    controller = start(stall_timeout=0.3, stall_velocity_threshold=0.01)
    goal = submit(controller, 0.4)
    robot.velocity[0] = 0.1
    robot.step(controller, 500)
    assert goal.status is GoalStatus.ACTIVE  # it moves

    robot.position[0], robot.velocity[0] = 0.25, 0.009
    robot.step(controller, 299)
    assert goal.status is GoalStatus.ACTIVE
    robot.step(controller, 3)

    assert goal.status is GoalStatus.ABORTED
    assert "'slide' stands still at 0.25 m, 0.15 m from" in goal.result.message
    assert goal.result.details["stalled"] is True
    assert goal.result.details["reached_goal"] is False
    assert goal.result.details["position"] == 0.25
    assert robot.positions_commanded[0] == 0.4


def test_a_goal_replaces_a_goal(robot, start, submit):
    controller = start()
    first, second = submit(controller, 0.4), submit(controller, 0.1)

    robot.run_with_position(controller, 3)

    assert first.status is GoalStatus.PREEMPTED
    assert "replaced" in first.result.message
    assert second.status is GoalStatus.SUCCEEDED
    assert robot.position[0] == 0.1


@pytest.mark.parametrize("end", ["cancel", "void"])
def test_a_cancelled_goal_stops_the_finger_where_it_is(robot, start, submit, end):
    controller = start()
    goal = submit(controller, 0.4)
    robot.step(controller, 5)
    robot.position[0] = 0.2

    if end == "cancel":
        controller.goals.cancel(goal.identifier)
    else:
        controller.goals.void("A reset.")
    robot.step(controller, 5)

    assert goal.status is GoalStatus.PREEMPTED
    assert robot.positions_commanded[0] == 0.2


@pytest.mark.parametrize(
    ("end", "status"),
    [
        ("stop_request", GoalStatus.PREEMPTED),
        ("abort_request", GoalStatus.ABORTED),
    ],
)
def test_a_goal_does_not_survive_its_controller(robot, start, submit, end, status):
    controller = start()
    active = submit(controller, 0.4)
    robot.step(controller)
    waiting = submit(controller, 0.3)

    getattr(controller, end)(robot.time)
    controller.start_request(robot.time)
    robot.step(controller, 5)

    assert (active.status, waiting.status) == (status, status)
    assert robot.positions_commanded[0] == 0.0


def test_without_any_effort_limit_it_is_refused(make_robot):
    from station.controllers.gripper_action_controller import (
        PositionGripperActionController,
    )

    robot = make_robot(["slide"], URDF_WITHOUT_EFFORT)
    with pytest.raises(ParameterError, match="max_effort"):
        robot.load(PositionGripperActionController, joint="slide")
    robot.load(PositionGripperActionController, joint="slide", max_effort=5.0)
    with pytest.raises(RobotDescriptionError):
        make_robot(["slide"], "").load(PositionGripperActionController, joint="slide")


def test_the_position_gripper_claims_its_joint_for_position_commands(start):
    (claim,) = start().claims

    assert claim.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claim.resources == ("slide",)


@pytest.mark.parametrize("delay", [1, 20])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_effort_of_a_goal_bounds_how_a_position_presses(
    robot, start, submit, delay, side
):
    controller = start()
    goal = submit(controller, 0.4 * side, max_effort=5.0)
    efforts = [0.0] * delay
    for _ in range(3000):
        robot.step(controller)
        # A servo of 10 kN/m that gives 40 N at most presses on an object at 0.1 m.
        robot.position[0] = max(-0.1, min(0.1, robot.positions_commanded[0]))
        way = robot.positions_commanded[0] - robot.position[0]
        efforts.append(max(-40.0, min(40.0, 1e4 * way)))
        robot.effort[0] = efforts[-delay]
    assert goal.status is GoalStatus.ABORTED
    assert max(abs(effort) for effort in efforts[500:]) <= 5.5
    assert max(effort * side for effort in efforts[-500:]) > 3.0


def test_a_finger_that_does_not_press_is_moved_as_far_as_the_goal_says(
    robot, start, submit
):
    controller = start()
    submit(controller, 0.4, max_effort=5.0)
    robot.effort[0] = -30.0  # a load that pulls it back is none of its pressing
    robot.step(controller)
    assert robot.positions_commanded[0] == 0.4


def test_a_goal_a_little_beyond_the_range_is_one_at_its_end(robot, start, submit):
    controller = start()
    submit(controller, 0.50009)
    robot.step(controller)
    assert robot.positions_commanded[0] == 0.5
