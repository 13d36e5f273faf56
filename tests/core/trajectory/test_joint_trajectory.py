"""Requested trajectories: order in time, and where now is."""

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import JointTrajectory, JointTrajectoryPoint
from station.core.trajectory.ros_time import to_nanoseconds


def _trajectory(*times, stamp=0.0):
    points = [JointTrajectoryPoint([0.0], time_from_start=time) for time in times]
    return JointTrajectory(["a"], points, stamp)


@pytest.mark.parametrize(
    ("times", "index"),
    [
        ((), None),
        ((1.0,), None),
        ((0.0, 1.0), None),
        ((1.0, 1.0), 1),
        ((1.0, 2.0, 1.5, 1.4), 2),
    ],
)
def test_points_have_to_be_strictly_increasing(times, index):
    assert _trajectory(*times).first_not_later() == index


def test_without_a_stamp_it_starts_now():
    assert _trajectory().start_nanoseconds(7) == 7
    assert _trajectory(stamp=2.0).start_nanoseconds(7) == 2_000_000_000


@pytest.mark.parametrize(
    ("now", "index"), [(9.9, None), (10.0, 0), (11.4, 0), (11.5, 1), (99.0, 1)]
)
def test_the_last_point_before_now_is_found(now, index):
    trajectory = _trajectory(0.0, 1.5, stamp=10.0)
    assert trajectory.last_point_before(to_nanoseconds(now)) == index


def test_a_stamp_has_to_be_finite():
    with pytest.raises(InvalidTrajectoryError, match="the stamp nan"):
        _trajectory(1.0, stamp=float("nan")).check_values()
