"""The URDF of an arm has the limits of its kind, and nothing else changes."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import RobotDescriptionError
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.urdf_loader import load_urdf

PANDA = "example-robot-data:panda"


def test_panda_is_as_its_urdf_says():
    assert load_arm_description(PANDA, PANDA_LIMITS) == load_robot_files(PANDA)


def test_fr3_of_a_pandas_urdf_gets_its_limits():
    joints = load_urdf(load_arm_description(PANDA, FR3_LIMITS)).joints
    # franka_description/robots/fr3/joint_limits.yaml
    limit, safety = joints["panda_joint6"].limit, joints["panda_joint6"].safety
    assert (limit.lower, limit.upper, limit.velocity) == (0.8521, 4.2094, 1.5)
    assert (safety.soft_lower_limit, safety.soft_upper_limit) == (0.8521, 4.2094)
    assert (safety.k_position, safety.k_velocity, limit.effort) == (100.0, 40.0, 12.0)
    speeds = [joints[f"panda_joint{number}"].limit.velocity for number in range(1, 8)]
    assert speeds == [2.0, 1.0, 1.5, 1.25, 3.0, 1.5, 3.0]


def test_links_and_fingers_stay():
    panda = load_urdf(load_robot_files(PANDA))
    fr3 = load_urdf(load_arm_description(PANDA, FR3_LIMITS))
    assert fr3.links == panda.links
    finger = "panda_finger_joint1"
    assert fr3.joints[finger] == panda.joints[finger]


def test_urdf_with_other_names_keeps_its_limits(tmp_path):
    path = tmp_path / "fr3.urdf"
    path.write_text(load_robot_files(PANDA).with_prefix("panda_", "fr3_").xml)
    joints = load_urdf(load_arm_description(str(path), FR3_LIMITS)).joints
    assert joints["fr3_joint6"].limit.upper == 3.7525


def test_other_robot_is_refused():
    with pytest.raises(RobotDescriptionError, match="no Franka arm"):
        load_arm_description("example-robot-data:ur5", PANDA_LIMITS)
