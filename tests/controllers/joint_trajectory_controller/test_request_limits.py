"""Requests beyond a joint's limits, or beyond anybody's patience."""

import pytest

from station.controllers.joint_trajectory_controller.request_limits import (
    MAX_DURATION,
    check_duration,
    check_positions,
)
from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import JointTrajectory, JointTrajectoryPoint

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
