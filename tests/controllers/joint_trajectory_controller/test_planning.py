"""Requests beyond a joint's limits, too fast for it, or too long are refused."""

import math

import pytest

from station.controllers.joint_trajectory_controller.planning import (
    MAX_DURATION,
    check_positions,
    check_segment,
    check_times,
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
        check_times(request, NOW)
    assert caught.value.details["reason"] == "duration"


@pytest.mark.parametrize(
    ("time", "stamp"), [(MAX_DURATION, 0.0), (0.6, 0.0), (1.0, 5.0), (1.0, NOW)]
)
def test_a_point_within_a_day_or_in_the_past_is_not(time, stamp):
    check_times(_request(time=time, stamp=stamp), NOW)


def test_positions_beyond_the_limits_are_refused():
    joint = JointDescription("a", lower=-1.0, upper=2.0)
    here = {"a": (0.0, 0.0)}
    check_positions(_request(2.00009), [joint], here)
    with pytest.raises(InvalidTrajectoryError, match=r"Point 1 .*'a'.*-1.0 to 2.0"):
        check_positions(_request(2.0002), [joint], here)


@pytest.mark.parametrize(
    ("positions", "refused"),
    [
        ([2.5, 1.0], None),
        ([2.4, 2.3], None),
        ([2.6], "Point 0"),
        ([2.4, 2.5], "Point 1"),
        ([2.5, 1.0, 2.5], "Point 2"),
    ],
)
def test_the_way_back_into_the_limits_is_open_and_the_way_out_is_not(
    positions, refused
):
    points = [JointTrajectoryPoint([each]) for each in positions]
    request = JointTrajectory(["a"], points)
    joint = JointDescription("a", lower=-1.0, upper=2.0)
    here = {"a": (1.9, 2.5)}
    if refused is None:
        check_positions(request, [joint], here)
        return
    with pytest.raises(InvalidTrajectoryError, match=refused):
        check_positions(request, [joint], here)


def segment(distance: float, duration: float) -> JointTrajectorySegment:
    end = PosVelAccState([distance])
    spline = QuinticSplineSegment(0.0, PosVelAccState([0.0]), duration, end)
    return JointTrajectorySegment(spline, end)


@pytest.mark.parametrize(
    ("distance", "limit"), [(1.0, 2.0), (-1.0, 2.0), (0.0, 0.0), (9e9, math.inf)]
)
def test_a_segment_at_the_velocity_limit_passes(distance, limit):
    check_segment(JointDescription("j", velocity=limit), segment(distance, 0.5))


@pytest.mark.parametrize("distance", [1.001, -1.001])
def test_a_segment_above_the_velocity_limit_is_refused_with_its_numbers(distance):
    with pytest.raises(InvalidTrajectoryError, match="limit is 2") as caught:
        check_segment(JointDescription("j", velocity=2.0), segment(distance, 0.5))

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
        check_segment(JointDescription("j", velocity=2.0), way)


def way_between(start, end):
    spline = QuinticSplineSegment(3.0, start, 4.0, end)
    return JointTrajectorySegment(spline, end)


@pytest.mark.parametrize(
    ("order", "peak"), [((0.0,), 1.5), ((0.0, 0.0), 1.875)], ids=["cubic", "quintic"]
)
def test_the_peak_between_two_rests_counts(order, peak):
    start, end = (PosVelAccState([x], *([y] for y in order)) for x in (0.0, -2.0))
    way = way_between(start, end)
    fast = JointDescription("j", velocity=2.0 * peak / 1.0999)
    slow = JointDescription("j", velocity=2.0 * peak / 1.1001)

    check_segment(fast, way)
    with pytest.raises(InvalidTrajectoryError, match=rf"with -{2 * peak:g} rad/s"):
        check_segment(slow, way)


def test_a_spline_that_swings_beyond_a_limit_is_refused_with_its_turning_point():
    start, end = PosVelAccState([1.0], [4.0]), PosVelAccState([1.0], [0.0])
    highest = 1.0 + 4.0 * 4.0 / 27.0  # of t (1 - t)^2, at a third
    way = way_between(start, end)

    check_segment(JointDescription("j", upper=highest), way)
    with pytest.raises(InvalidTrajectoryError, match=r"out to 1\.59259") as caught:
        check_segment(JointDescription("j", upper=highest - 2e-4), way)
    assert caught.value.details["position"] == pytest.approx(highest)


def test_a_segment_beyond_a_limit_may_lead_back_inside():
    start, end = (PosVelAccState([x], [0.0], [0.0]) for x in (2.5, 1.0))
    check_segment(JointDescription("j", upper=2.0), way_between(start, end))


def test_a_goal_that_starts_far_away_is_not_raced_to(robot, start, make_goal):
    controller = start()
    goal = make_goal((0.0, [0.4, 2.9, 1.0]), (0.1, [0.4, 3.0, 1.0]))

    with pytest.raises(InvalidTrajectoryError, match="'slide' would have"):
        controller.goals.submit(goal)

    robot.run_with_position(controller, 200)
    assert robot.position == [0.0, 0.0, 0.0]


def test_a_trajectory_may_have_to_end_at_rest(start, make_goal):
    controller = start(allow_nonzero_velocity_at_trajectory_end=False)
    point, rest = [0.1, 0.1, 0.1], [0.0, 0.0, 0.0]

    with pytest.raises(InvalidTrajectoryError, match=r"velocity of 0\.01 of 'elbow'"):
        controller.goals.submit(make_goal((1.0, point, [0.0, 0.01, 0.0])))
    # Velocities on the way and rounding at the end are allowed.
    way = (1.0, point, [0.0, 0.01, 0.0])
    controller.goals.submit(make_goal(way, (2.0, point, [1e-8, 0.0, 0.0])))
    controller.goals.submit(make_goal((1.0, point, rest)))
