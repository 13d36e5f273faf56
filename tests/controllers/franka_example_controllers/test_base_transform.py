"""The place of one base relative to another is read from the description."""

from math import pi

import numpy as np
import pytest

from station.controllers.franka_example_controllers.cartesian_impedance_controllers import (  # noqa: E501
    base_transform,
)
from station.core.errors import RobotDescriptionError

URDF = """
<robot name="two">
  <link name="world"/><link name="a_link0"/><link name="b_stand"/>
  <link name="b_link0"/><link name="hand"/>
  <joint name="ja" type="fixed">
    <parent link="world"/><child link="a_link0"/>
    <origin xyz="0 0.5 0" rpy="0 0 {yaw}"/>
  </joint>
  <joint name="jb" type="fixed">
    <parent link="world"/><child link="b_stand"/><origin xyz="1 0 0"/>
  </joint>
  <joint name="js" type="fixed">
    <parent link="b_stand"/><child link="b_link0"/>
    <origin xyz="0 0 0.25" rpy="0.1 0.2 0.3"/>
  </joint>
  <joint name="arm" type="{kind}">
    <parent link="world"/><child link="hand"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
</robot>
"""


def urdf(kind="revolute", yaw=pi / 2):
    return URDF.format(kind=kind, yaw=yaw)


def test_position_is_in_the_axes_of_the_first_base():
    found = base_transform(urdf(), "a_link0", "b_link0")

    assert found[:3, 3] == pytest.approx([-0.5, -1.0, 0.25])


def test_roll_pitch_and_yaw_turn_about_fixed_axes():
    found = base_transform(urdf(yaw=0.0), "a_link0", "b_link0")[:3, :3]

    def about(axis, angle):
        skew = np.cross(np.eye(3), axis)
        return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew

    x, y, z = np.eye(3)
    assert found == pytest.approx(about(z, 0.3) @ about(y, 0.2) @ about(x, 0.1))


def test_links_that_move_against_each_other_are_refused():
    with pytest.raises(RobotDescriptionError, match="are not fixed to the same link"):
        base_transform(urdf(), "a_link0", "hand")
    base_transform(urdf("fixed"), "a_link0", "hand")


def test_unknown_links_and_wrong_numbers_are_refused():
    with pytest.raises(RobotDescriptionError, match="no link 'c_link0'"):
        base_transform(urdf(), "a_link0", "c_link0")
    with pytest.raises(RobotDescriptionError, match="3 finite number"):
        base_transform(urdf(yaw="x"), "a_link0", "b_link0")
