"""Poses of joint frames, against yourdfpy and by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from viser.transforms import SO3

from station.core.description.urdf import JointType, Mimic, Pose
from station.core.description.urdf_parser import parse_urdf
from station.ui.scene.joint_frames import is_drawn_moving, pose_at, position_among
from station.ui.scene.robot_model import load_robot

ROOT_HALF = math.sqrt(0.5)


@pytest.fixture(scope="module")
def panda():
    return load_robot("example-robot-data:panda")


def make_joint(kind, origin, mimic=None):
    urdf = parse_urdf(
        '<robot name="r"><link name="a"/><link name="b"/><joint name="follower" '
        f'type="{kind}"><parent link="a"/><child link="b"/>'
        '<limit effort="1" velocity="1"/></joint></robot>'
    )
    return replace(urdf.joints["follower"], origin=origin, mimic=mimic)


def test_pandas_joint_frames_agree_with_yourdfpy(panda):
    drawing = panda.drawing
    names = drawing.actuated_joint_names
    q = np.random.default_rng(7).uniform(-0.5, 0.5, len(names))
    drawing.update_cfg(q)
    positions = dict(zip(names, q.tolist(), strict=True))
    for joint in panda.urdf.joints.values():
        expected = drawing.get_transform(joint.child, joint.parent)
        pose = pose_at(joint, position_among(joint, positions) or 0.0)
        rotation = SO3(np.array(pose.quaternion)).as_matrix()
        # Both compute in double precision.
        np.testing.assert_allclose(rotation, expected[:3, :3], atol=1e-9)
        np.testing.assert_allclose(pose.xyz, expected[:3, 3], atol=1e-9)


def test_a_sliding_joint_moves_along_its_turned_axis():
    quarter_turn_about_z = (ROOT_HALF, 0.0, 0.0, ROOT_HALF)
    joint = make_joint("prismatic", Pose((0.0, 0.0, 1.0), quarter_turn_about_z))
    pose = pose_at(joint, 0.5)
    assert pose.xyz == pytest.approx((0.0, 0.5, 1.0))
    assert pose.quaternion == quarter_turn_about_z


def test_a_mimic_joint_follows_its_rule_unless_its_position_is_measured():
    joint = make_joint("revolute", Pose(), Mimic("leader", -2.0, 0.1))
    assert position_among(joint, {"leader": 0.5}) == pytest.approx(-0.9)
    assert position_among(joint, {"leader": 0.5, "follower": 0.2}) == 0.2
    assert position_among(joint, {}) is None


@pytest.mark.parametrize(
    "kind", [JointType.FIXED, JointType.FLOATING, JointType.PLANAR]
)
def test_a_joint_that_is_not_drawn_moving_stays_at_its_origin(kind):
    joint = make_joint(kind.value, Pose((1.0, 2.0, 3.0)))
    assert not is_drawn_moving(joint)
    assert pose_at(joint, 0.7) == joint.origin


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_a_joint_with_one_axis_is_drawn_moving(kind):
    assert is_drawn_moving(make_joint(kind, Pose()))
