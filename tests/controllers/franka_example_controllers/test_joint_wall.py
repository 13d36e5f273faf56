"""Walls before joint limits: a damper, then a spring."""

import pytest

from station.controllers.franka_example_controllers.joint_wall import (
    JointWall,
    WallShape,
    wall_torques,
)
from station.core.errors import ControllerStateError

SHAPE = WallShape(0.1, 0.2, 1000.0, 30.0, 10.0)


def make_wall(q=0.0):
    wall = JointWall("elbow", -1.0, 2.0, SHAPE)
    wall.begin(q)
    return wall


@pytest.mark.parametrize(
    ("q", "dq", "expected"),
    [
        (0.0, 1.0, 0.0),
        (1.69, 1.0, 0.0),
        (1.75, 0.5, -10.0 * 0.5),
        (1.95, 0.5, 1000.0 * -0.05 - 30.0 * 0.5),
        (2.05, 0.0, 1000.0 * -0.15),
        (-0.75, -0.5, 10.0 * 0.5),
        (-0.95, -0.5, 1000.0 * 0.05 + 30.0 * 0.5),
    ],
)
def test_torque_depends_on_the_zone(q, dq, expected):
    assert make_wall().torque(q, dq) == pytest.approx(expected)


def test_joint_that_starts_in_the_wall_is_not_pushed_out():
    wall = make_wall(1.94)  # 0.06 of 0.3 left: the zones have a fifth of their width

    assert wall.torque(1.94, 0.0) == 0.0
    assert wall.torque(1.99, 0.0) == pytest.approx(1000.0 * -0.01)


def test_wall_grows_while_the_joint_leaves_it():
    wall = make_wall(1.94)
    wall.torque(1.85, -0.1)  # half of the width
    assert wall.torque(1.97, 0.1) == pytest.approx(1000.0 * -0.02 - 30.0 * 0.1)
    wall.torque(1.5, -0.1)

    assert wall.torque(1.95, 0.0) == pytest.approx(1000.0 * -0.05)


def test_lower_wall_grows_the_other_way_round():
    wall = make_wall(-0.94)
    wall.torque(-0.94, -0.1)
    assert wall.torque(-0.94, 0.0) == 0.0
    wall.torque(-0.6, 0.1)

    assert wall.torque(-0.95, 0.0) == pytest.approx(1000.0 * 0.05)


def test_joint_beyond_its_limits_is_refused():
    with pytest.raises(ControllerStateError, match=r"'elbow' is at 2\.1000 rad"):
        make_wall(2.1)


def test_torques_of_all_joints_are_returned():
    walls = [make_wall(), make_wall()]

    assert wall_torques(walls, [0.0, 2.05], [0.0, 0.0]) == pytest.approx([0.0, -150.0])
