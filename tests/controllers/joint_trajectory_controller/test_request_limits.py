"""Requests beyond a joint's limits, too fast for it, or too long are refused."""

import math

import pytest

from station.controllers.joint_trajectory_controller.request_limits import (
    MAX_DURATION,
    check_duration,
    check_positions,
    check_segment_velocity,
)
from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import (
    JointTrajectory,
    JointTrajectoryPoint,
    JointTrajectorySegment,
    PosVelAccState,
    QuinticSplineSegment,
)

NOW = 1000.0


def _request(position=0.0, time=1.0, stamp=0.0):
    points = [
        JointTrajectoryPoint([0.0], time_from_start=0.5),
        JointTrajectoryPoint([position], time_from_start=time),
    ]
    return JointTrajectory(["a"], points, stamp)


@pytest.mark.parametrize(
    ("time", "stamp"),
    [
        (MAX_DURATION + 1.0, 0.0),
        (1e9, 0.0),
        (1e300, 0.0),
        (1.0, 1e300),
        (2.0, NOW + MAX_DURATION - 1.0),
    ],
)
def test_a_point_that_is_due_in_more_than_a_day_is_refused(time, stamp):
    request = _request(time=time, stamp=stamp)
    with pytest.raises(InvalidTrajectoryError, match=r"allowed are 86400 s") as caught:
        check_duration(request, NOW)
    assert caught.value.details["reason"] == "duration"


@pytest.mark.parametrize(
    ("time", "stamp"), [(MAX_DURATION, 0.0), (-1e300, 0.0), (1.0, 5.0), (1.0, NOW)]
)
def test_a_point_within_a_day_or_in_the_past_is_not(time, stamp):
    check_duration(_request(time=time, stamp=stamp), NOW)


def test_positions_beyond_the_limits_are_refused():
    joint = JointDescription("a", lower=-1.0, upper=2.0)
    check_positions(_request(2.0), [joint])
    with pytest.raises(InvalidTrajectoryError, match=r"Point 1 .*'a'.*-1.0 to 2.0"):
        check_positions(_request(2.0001), [joint])


def segment(distance: float, duration: float) -> JointTrajectorySegment:
    end = PosVelAccState([distance])
    spline = QuinticSplineSegment(0.0, PosVelAccState([0.0]), duration, end)
    return JointTrajectorySegment(spline, end)


@pytest.mark.parametrize(
    ("distance", "limit"), [(1.0, 2.0), (-1.0, 2.0), (0.0, 0.0), (9e9, math.inf)]
)
def test_a_segment_at_the_velocity_limit_passes(distance, limit):
    check_segment_velocity(
        JointDescription("j", velocity=limit), segment(distance, 0.5)
    )


@pytest.mark.parametrize("distance", [1.001, -1.001])
def test_a_segment_above_the_velocity_limit_is_refused_with_its_numbers(distance):
    with pytest.raises(InvalidTrajectoryError, match="limit is 2") as caught:
        check_segment_velocity(
            JointDescription("j", velocity=2.0), segment(distance, 0.5)
        )

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
        check_segment_velocity(JointDescription("j", velocity=2.0), way)


def test_between_points_the_velocity_may_peak_as_from_rest_to_rest():
    start, end = (PosVelAccState([x], [0.0], [0.0]) for x in (0.0, 2.0))
    way = JointTrajectorySegment(QuinticSplineSegment(0.0, start, 1.0, end), end)

    check_segment_velocity(JointDescription("j", velocity=2.0), way)


def test_a_goal_that_starts_far_away_is_not_raced_to(robot, start, make_goal):
    controller = start()
    goal = make_goal((0.0, [0.4, 2.9, 1.0]), (0.1, [0.4, 3.0, 1.0]))

    with pytest.raises(InvalidTrajectoryError, match="'slide' would have"):
        controller.goals.submit(goal)

    robot.run_with_position(controller, 200)
    assert robot.position == [0.0, 0.0, 0.0]
