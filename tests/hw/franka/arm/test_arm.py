"""Names of an arm's joints, and what an arm that nobody configured allows."""

from math import inf

from station.core.description.robot_files import load_robot_files
from station.hw.franka.arm.arm_description import find_prefix, joint_names
from station.hw.franka.arm.arm_limits import SupervisorLimits


def test_joints_are_counted_from_the_base():
    assert joint_names("left")[0] == "left_joint1"
    assert len(joint_names("left")) == 7


def test_prefix_is_found():
    assert find_prefix(load_robot_files("example-robot-data:panda")) == "panda_"


def test_arm_has_no_walls_and_no_limit_of_power_unless_they_are_configured():
    limits = SupervisorLimits()

    assert limits.power == inf
    assert limits.cartesian_lower == (-inf,) * 3
    assert limits.cartesian_upper == (inf,) * 3
