"""The joints by which a moving root link is drawn put it where the station says."""

import math

import pytest

from station.core.description.urdf import multiply
from station.ui.scene.joint_frames import link_poses
from station.ui.scene.robot_model import base_positions, load_robot
from station.wire import MovingBase


@pytest.fixture(scope="module")
def robot():
    return load_robot("example-robot-data:ur5", moves=True)


def _turned(angle, axis):
    half = angle / 2.0
    return (math.cos(half), *(math.sin(half) * part for part in axis))


@pytest.mark.parametrize("angles", [(0.3, -0.4, 2.5), (-3.0, 1.2, 0.1), (0, 0, 0)])
def test_the_root_link_is_drawn_where_the_station_says(robot, angles):
    roll, pitch, yaw = angles
    # The convention of URDF: about the fixed x, then y, then z axis.
    turn = multiply(
        multiply(_turned(yaw, (0, 0, 1)), _turned(pitch, (0, 1, 0))),
        _turned(roll, (1, 0, 0)),
    )
    base = MovingBase(
        link=robot.root,
        position=[1.5, -2.0, 0.4],
        orientation=[*turn[1:], turn[0]],
    )
    pose = link_poses(robot.urdf, base_positions(base))[robot.root]
    assert pose.xyz == pytest.approx((1.5, -2.0, 0.4))
    sign = math.copysign(1.0, pose.quaternion[0] * turn[0])
    assert [sign * part for part in pose.quaternion] == pytest.approx(turn)


def test_a_pose_that_is_not_finite_moves_nothing():
    base = MovingBase(link="a", position=[None, 0, 0], orientation=[0, 0, 0, 1])
    assert base_positions(base) == {}


def test_nobody_commands_the_joints_of_the_base(robot):
    names = set(load_robot("example-robot-data:ur5").joint_limits())
    assert set(robot.joint_limits()) == names
