"""Poses of joint frames, against yourdfpy and by hand."""

import math

import numpy as np
import pytest
from viser.transforms import SO3

from station.ui.joint_frames import JointFrame, Mimic, Motion
from station.ui.robot_model import joint_frames, load_robot

ROOT_HALF = math.sqrt(0.5)


@pytest.fixture(scope="module")
def panda():
    return load_robot("example-robot-data:panda")


def test_pandas_joint_frames_agree_with_yourdfpy(panda):
    q = np.random.default_rng(7).uniform(-0.5, 0.5, len(panda.actuated_joint_names))
    panda.update_cfg(q)
    positions = dict(zip(panda.actuated_joint_names, q.tolist(), strict=True))
    for child, frame in joint_frames(panda).items():
        expected = panda.get_transform(child, panda.joint_map[frame.name].parent)
        at = frame.position_among(positions) or 0.0
        rotation = SO3(np.array(frame.wxyz_at(at))).as_matrix()
        # Both compute in double precision.
        np.testing.assert_allclose(rotation, expected[:3, :3], atol=1e-9)
        np.testing.assert_allclose(frame.position_at(at), expected[:3, 3], atol=1e-9)


def test_a_sliding_joint_moves_along_its_turned_axis():
    quarter_turn_about_z = (ROOT_HALF, 0.0, 0.0, ROOT_HALF)
    frame = JointFrame(
        "slide",
        Motion.TRANSLATION,
        (1.0, 0.0, 0.0),
        (0.0, 0.0, 1.0),
        quarter_turn_about_z,
    )
    assert frame.position_at(0.5) == pytest.approx((0.0, 0.5, 1.0))
    assert frame.wxyz_at(0.5) == quarter_turn_about_z


def test_a_following_joint_obeys_its_rule_unless_it_is_measured():
    frame = JointFrame(
        "follower",
        Motion.ROTATION,
        (0.0, 0.0, 1.0),
        (0.0, 0.0, 0.0),
        (1.0, 0.0, 0.0, 0.0),
        Mimic("leader", -2.0, 0.1),
    )
    assert frame.position_among({"leader": 0.5}) == pytest.approx(-0.9)
    assert frame.position_among({"leader": 0.5, "follower": 0.2}) == 0.2
    assert frame.position_among({}) is None


@pytest.mark.parametrize(
    ("kind", "motion"),
    [
        ("revolute", Motion.ROTATION),
        ("continuous", Motion.ROTATION),
        ("prismatic", Motion.TRANSLATION),
        ("fixed", Motion.FIXED),
        ("floating", Motion.FIXED),
    ],
)
def test_every_urdf_type_has_a_motion(kind, motion):
    assert Motion.of_urdf_type(kind) is motion
