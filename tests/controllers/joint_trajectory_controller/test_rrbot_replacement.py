"""The original's tests, re-told: what replaces a trajectory, and what is too old to.

All of them interrupt a motion at about its first waypoint.
"""

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import GoalStatus
from tests.controllers.joint_trajectory_controller.rrbot import END, HOME, WAYPOINTS


@pytest.fixture(params=["topic", "action"])
def moving(request, rrbot):
    """Return the robot at its first waypoint, and the goal if there is one."""
    goal = None
    if request.param == "topic":
        rrbot.publish(*WAYPOINTS)
    else:
        goal = rrbot.send(*WAYPOINTS)
    rrbot.run(1.1)
    assert goal is None or goal.status is GoalStatus.ACTIVE
    return rrbot, goal


def test_the_topic_replaces_what_is_executed(moving):
    rrbot, goal = moving
    rrbot.publish(HOME)
    rrbot.run(0.02)
    assert goal is None or goal.status is GoalStatus.PREEMPTED
    rrbot.run(1.5)
    assert rrbot.is_at(HOME[1])


def test_a_goal_replaces_what_is_executed(moving):
    rrbot, goal = moving
    home = rrbot.send(HOME)
    rrbot.run(0.02)
    assert home.status is GoalStatus.ACTIVE
    assert goal is None or goal.status is GoalStatus.PREEMPTED
    rrbot.finish(home)
    assert home.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(HOME[1])


def test_an_empty_topic_message_stops_where_the_joints_are(moving):
    rrbot, goal = moving
    rrbot.publish(joints=[])
    rrbot.run(0.02)
    assert goal is None or goal.status is GoalStatus.PREEMPTED
    rrbot.run(rrbot.stop_duration + 0.5)
    assert rrbot.stands()
    assert rrbot.desired()[0] > 0.5


def test_an_empty_goal_stops_where_the_joints_are_and_succeeds(moving):
    rrbot, goal = moving
    empty = rrbot.send()
    rrbot.run(0.02)
    assert goal is None or goal.status is GoalStatus.PREEMPTED
    rrbot.finish(empty, rrbot.stop_duration + 0.6)
    assert empty.status is GoalStatus.SUCCEEDED
    assert rrbot.stands()
    assert rrbot.desired()[0] > 0.5


def test_a_cancelled_goal_is_preempted_and_the_joints_stop(rrbot):
    goal = rrbot.send(*WAYPOINTS)
    rrbot.run(1.1)
    rrbot.station.motion.cancel_goal(rrbot.name, goal.identifier)
    rrbot.run(0.02)
    assert goal.status is GoalStatus.PREEMPTED
    rrbot.run(rrbot.stop_duration + 0.5)
    assert rrbot.stands()


def test_a_stop_ramp_does_not_turn_a_late_robot_round(make_rrbot):
    rrbot = make_rrbot("stop ramp")
    rrbot.hw.is_late = True
    goal = rrbot.send((4.0, WAYPOINTS[0][1]))
    rrbot.run(2.0)
    rrbot.publish(joints=[])
    slowest = 0.0
    for _ in range(100):
        rrbot.run(0.01)
        slowest = min(slowest, *rrbot.state()["actual"]["velocities"])
    assert goal.status is GoalStatus.PREEMPTED
    assert rrbot.stands()
    assert slowest >= -1e-9


@pytest.mark.parametrize("tolerance", [1.0, 0.05])
def test_a_stop_holds_or_ramps_what_is_desired_unless_a_joint_left_its_path(
    original_rrbot, tolerance
):
    rrbot = original_rrbot
    wall = WAYPOINTS[0][1][0] / 3.0
    rrbot.reload(**{"constraints/joint1/trajectory": tolerance})
    rrbot.hw.is_late, rrbot.hw.upper_bound = True, wall
    rrbot.publish(WAYPOINTS[0])
    rrbot.run(0.55)
    rrbot.publish(joints=[])
    rrbot.run(1.0)
    if rrbot.stop_duration == 0.0 and tolerance < 0.1:
        assert rrbot.desired()[0] == pytest.approx(wall, abs=0.01)
    else:
        assert rrbot.desired()[0] > wall + 0.05


def test_what_lies_in_the_past_is_refused_and_replaces_nothing(moving):
    rrbot, goal = moving
    late = rrbot.now - HOME[0]
    with pytest.raises(InvalidTrajectoryError, match="in the past"):
        rrbot.publish(HOME, stamp=late)
    with pytest.raises(InvalidTrajectoryError, match="in the past") as caught:
        rrbot.send(HOME, stamp=late)
    assert caught.value.details["error_code"] == -1
    rrbot.run(3.5)
    assert goal is None or goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(END)


def test_a_goal_that_was_over_before_it_came_is_refused(rrbot):
    rrbot.run(1.0)
    with pytest.raises(InvalidTrajectoryError, match="in the past"):
        rrbot.send(HOME, stamp=rrbot.now - HOME[0])
    assert rrbot.station.motion.goals(rrbot.name) == []


def test_only_the_points_to_come_are_executed(rrbot):
    first = rrbot.send(*WAYPOINTS[:2])
    rrbot.run(1.1)
    points = [(0.9, WAYPOINTS[0][1]), (3.0, WAYPOINTS[1][1]), (5.0, END)]
    goal = rrbot.send(*points, stamp=rrbot.now - 1.0)
    rrbot.run(0.02)
    assert first.status is GoalStatus.PREEMPTED
    assert goal.status is GoalStatus.ACTIVE
    rrbot.run(1.98)
    assert rrbot.desired() == pytest.approx(WAYPOINTS[1][1], abs=0.01)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED
    assert rrbot.is_at(END)
