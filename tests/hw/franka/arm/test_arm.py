"""Names of an arm's joints."""

from station.core.description.robot_files import load_robot_files
from station.hw.franka.arm.arm_names import find_prefix, joint_names


def test_joints_are_counted_from_the_base():
    assert joint_names("left")[0] == "left_joint1"
    assert len(joint_names("left")) == 7


def test_prefix_is_found():
    assert find_prefix(load_robot_files("example-robot-data:panda")) == "panda_"
