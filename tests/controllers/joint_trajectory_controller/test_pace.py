"""A way that is too fast on average is refused."""

import math

import pytest

from station.controllers.joint_trajectory_controller.pace import check_pace
from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import (
    JointTrajectorySegment,
    PosVelAccState,
    QuinticSplineSegment,
)


def segment(distance: float, duration: float) -> JointTrajectorySegment:
    end = PosVelAccState([distance])
    spline = QuinticSplineSegment(0.0, PosVelAccState([0.0]), duration, end)
    return JointTrajectorySegment(spline, end)


@pytest.mark.parametrize(
    ("distance", "limit"), [(1.0, 2.0), (-1.0, 2.0), (0.0, 0.0), (9e9, math.inf)]
)
def test_a_way_at_the_limit_passes(distance, limit):
    check_pace(JointDescription("j", velocity=limit), segment(distance, 0.5))


@pytest.mark.parametrize("distance", [1.001, -1.001])
def test_a_faster_one_is_refused_with_its_numbers(distance):
    with pytest.raises(InvalidTrajectoryError, match="limit is 2") as caught:
        check_pace(JointDescription("j", velocity=2.0), segment(distance, 0.5))

    details = caught.value.details
    assert (details["reason"], details["joint"]) == ("pace", "j")
    assert details["distance"] == pytest.approx(distance)


@pytest.mark.parametrize(
    "end",
    [
        PosVelAccState([0.1], [2.001]),
        PosVelAccState([0.1], [1e9]),
        PosVelAccState([0.1], [0.0], [1e9]),
        PosVelAccState([0.1], [0.0], [1e300]),
    ],
)
def test_points_that_ask_for_an_impossible_velocity_are_refused(end):
    start = PosVelAccState([0.0], [0.0], [0.0])
    way = JointTrajectorySegment(QuinticSplineSegment(0.0, start, 1.0, end), end)

    with pytest.raises(InvalidTrajectoryError, match="limit is 2 rad/s"):
        check_pace(JointDescription("j", velocity=2.0), way)


def test_the_velocity_between_the_points_may_be_what_a_smooth_way_needs():
    start, end = (PosVelAccState([x], [0.0], [0.0]) for x in (0.0, 2.0))
    way = JointTrajectorySegment(QuinticSplineSegment(0.0, start, 1.0, end), end)

    check_pace(JointDescription("j", velocity=2.0), way)


def test_a_goal_that_starts_far_away_is_not_raced_to(robot, start, make_goal):
    controller = start()
    goal = make_goal((0.0, [0.4, 2.9, 1.0]), (0.1, [0.4, 3.0, 1.0]))

    with pytest.raises(InvalidTrajectoryError, match="'slide' would have"):
        controller.goals.submit(goal)

    robot.run_with_position(controller, 200)
    assert robot.position == [0.0, 0.0, 0.0]
