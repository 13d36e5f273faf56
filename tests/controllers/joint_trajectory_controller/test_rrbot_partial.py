"""The original's tests, re-told: trajectories for one of the two joints."""

from math import pi

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import GoalStatus
from tests.controllers.joint_trajectory_controller.rrbot import (
    END,
    EPS,
    HOME,
    WAYPOINTS,
    trajectory,
)

PARTIAL = [(1.0, [pi / 4]), (2.0, [pi / 2]), (4.0, [-pi / 2])]
MIXED = [END[0], -pi / 2]


@pytest.fixture
def rrbot(make_rrbot):
    return make_rrbot("rrbot_partial_controllers.yaml")


@pytest.fixture(params=["topic", "action"])
def moving(request, rrbot):
    """Return the robot after the first waypoint for both joints, and the goal."""
    rrbot.run(4.0)
    goal = None
    if request.param == "topic":
        rrbot.publish(*WAYPOINTS)
    else:
        goal = rrbot.send(*WAYPOINTS)
    rrbot.run(1.1)
    return rrbot, goal


def _no_positions(message):
    message["points"][0]["positions"] = []


def _one_position(message):
    message["points"][0]["positions"] = [0.0]


def _bad_name(message):
    message["joint_names"][0] = "bad_name"


def _same_time(message):
    message["points"].append(message["points"][0])


def _empty(message):
    message.clear()


@pytest.mark.parametrize(
    ("spoil", "code"),
    [
        (_bad_name, -2),
        (_no_positions, -1),
        (_one_position, -1),
        (_same_time, -1),
        (_empty, -2),
    ],
)
def test_what_is_wrong_with_all_joints_is_wrong_with_some(rrbot, spoil, code):
    message = trajectory(HOME)
    spoil(message)
    with pytest.raises(InvalidTrajectoryError) as caught:
        rrbot.station.motion.submit_goal(rrbot.name, {"trajectory": message})
    assert caught.value.details["error_code"] == code


def test_a_goal_for_one_joint_becomes_active(rrbot):
    goal = rrbot.send(*PARTIAL, joints=["joint2"])
    rrbot.run(0.02)
    assert goal.status is GoalStatus.ACTIVE


def test_a_published_trajectory_for_one_joint_is_followed(rrbot):
    rrbot.publish(*PARTIAL, joints=["joint2"])
    rrbot.run(4.5)
    assert rrbot.is_at([0.0, -pi / 2])
    query = rrbot.station.motion.query_state(rrbot.name)
    assert query.position == rrbot.desired()


def test_a_goal_for_one_joint_succeeds(rrbot):
    goal = rrbot.send(*PARTIAL, joints=["joint2"])
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    assert goal.result.code == 0
    assert rrbot.is_at([0.0, -pi / 2])


def test_the_topic_replaces_one_joint_and_the_other_goes_on(moving):
    rrbot, goal = moving
    rrbot.publish(*PARTIAL, joints=["joint2"])
    rrbot.run(0.02)
    assert goal is None or goal.status is GoalStatus.PREEMPTED
    rrbot.run(4.5)
    assert rrbot.is_at(MIXED)


def test_a_goal_replaces_one_joint_and_the_other_goes_on(moving):
    rrbot, goal = moving
    partial = rrbot.send(*PARTIAL, joints=["joint2"])
    rrbot.run(0.02)
    assert partial.status is GoalStatus.ACTIVE
    assert goal is None or goal.status is GoalStatus.PREEMPTED
    rrbot.finish(partial)
    assert partial.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(MIXED)


def test_what_lies_in_the_past_replaces_no_joint(moving):
    rrbot, goal = moving
    late = rrbot.now - PARTIAL[-1][0] - 0.5
    for send in (rrbot.publish, rrbot.send):
        with pytest.raises(InvalidTrajectoryError, match="in the past"):
            send(*PARTIAL, joints=["joint2"], stamp=late)
    rrbot.run(3.5)
    assert goal is None or goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(END)


def test_only_the_points_to_come_are_executed_for_one_joint(rrbot):
    rrbot.run(4.0)
    first = rrbot.send(*WAYPOINTS)
    rrbot.run(1.1)
    partial = rrbot.send(*PARTIAL, joints=["joint2"], stamp=rrbot.now - 3.0)
    rrbot.run(0.02)
    assert first.status is GoalStatus.PREEMPTED
    assert partial.status is GoalStatus.ACTIVE
    # 1.0 s are left for joint2; joint1 has 2.9 s to go.
    rrbot.run(0.98)
    assert rrbot.desired()[1] == pytest.approx(-pi / 2, abs=EPS)
    rrbot.finish(partial)
    assert partial.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(MIXED)


def test_a_goal_for_one_joint_may_begin_after_the_present_trajectory(rrbot):
    first = rrbot.send(*WAYPOINTS)
    rrbot.run(1.1)
    partial = rrbot.send(*PARTIAL, joints=["joint2"], stamp=rrbot.now + 6.0)
    rrbot.run(0.02)
    assert first.status is GoalStatus.PREEMPTED
    assert partial.status is GoalStatus.ACTIVE
    rrbot.run(4.0)
    assert rrbot.is_at(END)
    rrbot.finish(partial, 8.0)
    assert partial.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(MIXED)
