"""The original's tests, re-told: states, refusals, undisturbed trajectories."""

from math import pi

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import GoalStatus
from tests.controllers.joint_trajectory_controller.rrbot import (
    END,
    EPS,
    HOME,
    JOINTS,
    WAYPOINTS,
    trajectory,
)

INVALID_GOAL, INVALID_JOINTS = -1, -2
REST = {"velocities": [0.0, 0.0], "accelerations": [0.0, 0.0]}


def refusal(rrbot, message):
    """Send a goal that is refused; return what is said about it."""
    with pytest.raises(InvalidTrajectoryError) as caught:
        rrbot.station.motion.submit_goal(rrbot.name, {"trajectory": message})
    assert rrbot.station.motion.goals(rrbot.name) == []
    return caught.value.details["error_code"]


def test_the_state_tells_all_joints_but_no_measured_accelerations(rrbot):
    state = rrbot.state()
    assert state["joint_names"] == JOINTS
    for what in ("desired", "actual", "error"):
        assert len(state[what]["positions"]) == len(JOINTS)
        assert len(state[what]["velocities"]) == len(JOINTS)
    assert len(state["desired"]["accelerations"]) == len(JOINTS)
    assert state["actual"]["accelerations"] == []
    assert state["error"]["accelerations"] == []


def test_the_desired_state_of_a_time_tells_all_joints(rrbot):
    state = rrbot.station.motion.query_state(rrbot.name, rrbot.now)
    assert rrbot.station.manager.get_controller(rrbot.name).joint_names == JOINTS
    for values in (state.position, state.velocity, state.acceleration):
        assert len(values) == len(JOINTS)


def test_a_goal_for_some_joints_is_refused(rrbot):
    message = trajectory((1.0, [0.0]), joints=["joint1"])
    assert refusal(rrbot, message) == INVALID_JOINTS


def test_a_goal_for_an_unknown_joint_is_refused(rrbot):
    message = trajectory(HOME, joints=["bad_name", "joint2"])
    assert refusal(rrbot, message) == INVALID_JOINTS


def test_a_goal_without_positions_is_refused(rrbot):
    message = trajectory(HOME)
    message["points"][0]["positions"] = []
    assert refusal(rrbot, message) == INVALID_GOAL


@pytest.mark.parametrize("what", ["positions", "velocities", "accelerations"])
def test_a_goal_with_too_few_numbers_is_refused(rrbot, what):
    message = trajectory(HOME)
    message["points"][0][what] = [0.0]
    assert refusal(rrbot, message) == INVALID_GOAL


def test_a_goal_whose_times_do_not_increase_is_refused(rrbot):
    first, second, third = WAYPOINTS
    message = trajectory(first, second, (second[0], third[1]))
    assert refusal(rrbot, message) == INVALID_GOAL


@pytest.mark.parametrize("message", [{}, {"joint_names": []}, {"points": []}])
def test_an_empty_goal_without_joints_is_refused(rrbot, message):
    assert refusal(rrbot, message) == INVALID_JOINTS


def test_an_empty_goal_for_other_joints_is_refused(rrbot):
    message = trajectory(joints=["joint1", "bad_name"])
    assert refusal(rrbot, message) == INVALID_JOINTS


def test_a_published_trajectory_is_followed_to_its_end(rrbot):
    rrbot.publish(*WAYPOINTS)
    rrbot.run(4.5)
    assert rrbot.is_at(END)
    state, query = rrbot.state(), rrbot.station.motion.query_state(rrbot.name)
    assert state["error"]["positions"] == pytest.approx([0.0, 0.0], abs=EPS)
    assert state["error"]["velocities"] == pytest.approx([0.0, 0.0], abs=EPS)
    assert query.position == state["desired"]["positions"]
    assert query.velocity == state["desired"]["velocities"]
    assert query.acceleration == state["desired"]["accelerations"]


def test_a_goal_is_followed_to_its_end_and_succeeds(rrbot):
    goal = rrbot.send(*WAYPOINTS)
    rrbot.run(1.0)
    assert goal.status is GoalStatus.ACTIVE
    # It began at the next cycle, whose time is one period on.
    assert rrbot.desired() == pytest.approx(WAYPOINTS[0][1], abs=EPS)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    assert goal.result.code == 0
    assert rrbot.is_at(END)


def test_joints_may_have_another_order(rrbot):
    goal = rrbot.send((1.0, [pi / 4, 0.0]), joints=["joint2", "joint1"])
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at([0.0, pi / 4])


def test_continuous_joints_leave_whole_turns_out(rrbot):
    rrbot.finish(rrbot.send((1.0, [0.75 * pi, -0.5 * pi])))
    goal = rrbot.send((1.0, [-0.75 * pi, 0.75 * pi]))
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at([1.25 * pi, -1.25 * pi])


def test_a_position_beyond_half_a_turn_counts_its_turns(rrbot):
    goal = rrbot.send((9.0, [4.5 * pi, -1.75 * pi]))
    rrbot.finish(goal, 12.0)
    assert goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at([4.5 * pi, -1.75 * pi])


def test_half_a_turn_keeps_its_direction(rrbot):
    rrbot.finish(rrbot.send((1.0, [-pi / 2, 0.0])))
    goal = rrbot.send((2.0, [pi / 2, 0.0]))
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at([pi / 2, 0.0])


def test_velocity_feed_forward_is_needed_to_stay_on_the_path(make_rrbot):
    rrbot = make_rrbot("velocity")
    goal = rrbot.send(*WAYPOINTS)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    rrbot.finish(rrbot.send(HOME))
    rrbot.reload(**{"velocity_ff/joint1": 0.0, "velocity_ff/joint2": 0.0})
    goal = rrbot.send(*WAYPOINTS)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.code == -4
