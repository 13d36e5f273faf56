"""What a person says becomes a goal of a trajectory controller."""

import pytest

from station.client.errors import MotionError
from station.client.joint_goals import joint_positions, trajectory_goal

NAMES = ["a", "b"]


def test_joints_that_are_not_named_stay():
    assert joint_positions({"b": 1.0}, NAMES, [0.5, None]) == [0.5, 1.0]
    assert joint_positions([1.0, 2.0], NAMES, [0.0, 0.0]) == [1.0, 2.0]


def test_unknown_joint_is_refused_with_those_there_are():
    with pytest.raises(MotionError, match=r"no joint 'c'\. The joints are: a, b"):
        joint_positions({"c": 1.0}, NAMES, [0.0, 0.0])


@pytest.mark.parametrize(
    ("values", "duration", "expected"),
    [
        ([0.1, 0.0], None, 1.0),  # the shortest
        ([0.1, -2.0], None, 4.0),  # 2 rad at 0.5 rad/s
        ([0.1, -2.0], 7.0, 7.0),
    ],
)
def test_goal_ends_at_rest_after_a_calm_time(values, duration, expected):
    goal = trajectory_goal(NAMES, [0.0, 0.0], values, duration)

    (point,) = goal["trajectory"]["points"]
    assert goal["trajectory"]["joint_names"] == NAMES
    assert point["positions"] == values
    assert point["velocities"] == [0.0, 0.0]
    assert point["time_from_start"] == expected
