"""Named poses are those of Franka arms, whatever their names begin with."""

import pytest

from station.client.poses import POSES, UnknownPoseError, check_name, positions_of
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
