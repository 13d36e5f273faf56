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
