"""The original's tests, re-told: joints that lag behind, and sensors that wrap.

What is different here: after a violated tolerance the original goes on along the path;
here the joints are stopped and held, in these tests too.
"""

from math import pi

import pytest

from station.core.ports.goal import GoalStatus
from tests.controllers.joint_trajectory_controller.rrbot import (
    ANY_PATH,
    HOME,
    JOINTS,
    WAYPOINTS,
    WrappingRRBotHW,
)

PATH, GOAL = -4, -5
SLUGGISH = [[0.9, 0.9], [0.9, 0.0], [0.0, 0.9]]
# More than a goal_time is needed from here on.
VERY_SLUGGISH = [[0.95, 0.95], [0.97, 0.0], [0.0, 0.95]]


@pytest.mark.parametrize("smoothing", SLUGGISH)
def test_a_joint_that_leaves_the_path_aborts_the_goal(original_rrbot, smoothing):
    rrbot = original_rrbot
    rrbot.hw.smoothing = smoothing
    goal = rrbot.send(*WAYPOINTS)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.code == PATH
    slow = [name for name, part in zip(JOINTS, smoothing, strict=True) if part]
    assert goal.result.details["joint"] in slow
    assert abs(goal.result.details["error"]) > goal.result.details["tolerance"] == 0.05


@pytest.mark.parametrize("smoothing", VERY_SLUGGISH)
def test_a_joint_that_arrives_too_late_aborts_the_goal(original_rrbot, smoothing):
    rrbot = original_rrbot
    rrbot.hw.smoothing = smoothing
    goal = rrbot.send(*WAYPOINTS, path_tolerance=ANY_PATH)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.code == GOAL
    slow = [name for name, part in zip(JOINTS, smoothing, strict=True) if part]
    assert goal.result.details["joint"] in slow


def test_after_an_abort_the_joints_hold_and_the_next_goal_is_reached(original_rrbot):
    rrbot = original_rrbot
    rrbot.hw.smoothing = [0.9, 0.9]
    rrbot.finish(rrbot.send(*WAYPOINTS))
    assert rrbot.stands()
    held = rrbot.desired()
    rrbot.hw.smoothing = [0.0, 0.0]
    rrbot.run(1.0)
    assert rrbot.is_at(held)
    goal = rrbot.send(HOME)
    rrbot.finish(goal)
    assert goal.status is GoalStatus.SUCCEEDED


def test_errors_of_wrapping_sensors_are_taken_the_short_way(make_rrbot):
    rrbot = make_rrbot("rrbot_wrapping_controllers.yaml", robot=WrappingRRBotHW)
    rrbot.hw.joints.position[:] = [pi - 0.1, 0.1 - pi]
    rrbot.reload()
    rrbot.hw.smoothing = [0.25, 0.25]
    goal = rrbot.send(
        (1.0, [pi + 0.01, -pi - 0.01]),
        (2.0, [pi + 0.06, -pi - 0.06]),
        (4.0, [pi + 0.1, -pi - 0.01]),
        path_tolerance=ANY_PATH,
    )
    largest = 0.0
    for _ in range(460):
        rrbot.run(0.01)
        largest = max(largest, *map(abs, rrbot.state()["error"]["positions"]))
    assert goal.status is GoalStatus.SUCCEEDED
    # Bound of the original; taken the long way it would be about 2 pi.
    assert 0.0 < largest < 0.7
    assert rrbot.state()["actual"]["positions"] == pytest.approx(
        [0.1 - pi, pi - 0.01], abs=0.01
    )
