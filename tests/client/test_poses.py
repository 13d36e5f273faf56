"""Named poses, and goals from what a person says."""

import pytest

from station.client.errors import MotionError
from station.client.poses import (
    POSES,
    UnknownPoseError,
    check_name,
    joint_positions,
    positions_of,
    trajectory_goal,
)
from station.config import load_config
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS


@pytest.mark.parametrize("arm", ["panda", "left_arm"])
def test_a_pose_follows_the_order_of_the_joints(arm):
    joints = [f"{arm}_joint{number}" for number in (4, 1, 2, 3, 5, 6, 7)]

    assert positions_of("ready", joints)[:2] == pytest.approx([-2.356, 0.0], abs=1e-3)


def test_other_robots_have_no_such_poses():
    with pytest.raises(UnknownPoseError, match="7 joints of a Franka"):
        positions_of("ready", ["shoulder", "elbow"])


def test_what_is_unknown_is_told_with_what_there_is():
    with pytest.raises(UnknownPoseError, match="The poses are: ready, stretched"):
        check_name("kitchen")


@pytest.mark.parametrize("limits", [PANDA_LIMITS, FR3_LIMITS])
@pytest.mark.parametrize("pose", POSES)
def test_poses_are_within_the_limits_of_the_arms(pose, limits):
    positions = positions_of(pose, [f"a_joint{number}" for number in range(1, 8)])

    for low, q, high in zip(limits.lower, positions, limits.upper, strict=True):
        assert low < q < high


def test_the_default_station_has_a_controller_for_them():
    kinds = {c.type for c in load_config().controllers.values()}

    assert "position_controllers/JointTrajectoryController" in kinds


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
