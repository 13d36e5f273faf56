"""Poses and trees of a URDF."""

from math import pi, sqrt

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import Link, Pose
from station.core.description.urdf_parser import parse_urdf


def test_pose_of_a_quarter_turn_about_z() -> None:
    pose = Pose.from_rpy((1.0, 2.0, 3.0), (0.0, 0.0, pi / 2))
    assert pose.xyz == (1.0, 2.0, 3.0)
    assert pose.quaternion == pytest.approx((sqrt(0.5), 0.0, 0.0, sqrt(0.5)))


def test_composed_pose_turns_the_inner_translation() -> None:
    outer = Pose.from_rpy((1.0, 0.0, 0.0), (0.0, 0.0, pi / 2))
    inner = Pose.from_rpy((2.0, 0.0, 0.5), (0.0, 0.0, pi / 2))
    composed = outer.compose(inner)
    assert composed.xyz == pytest.approx((1.0, 2.0, 0.5))
    assert composed.quaternion == pytest.approx((0.0, 0.0, 0.0, 1.0))


def test_joints_below_a_link_are_its_own() -> None:
    urdf = parse_urdf(load_robot_files("example-robot-data:panda").xml)
    below = [joint.name for joint in urdf.joints_below("panda_hand")]
    assert below == [
        "panda_hand_tcp_joint",
        "panda_finger_joint1",
        "panda_finger_joint2",
    ]
    assert urdf.joints_below("panda_leftfinger") == []


def test_link_without_mass_and_shape_is_a_frame() -> None:
    assert Link("frame", None, ()).is_frame_only


def test_fixed_root_ends_at_the_first_joint_that_moves() -> None:
    urdf = parse_urdf(load_robot_files("example-robot-data:panda").xml)
    root, pose = urdf.fixed_root("panda_hand_tcp")
    assert root == "panda_link7"
    # The flange is 0.107 m, the tip of the fingers 0.1034 m from the last joint.
    assert pose.xyz == pytest.approx((0.0, 0.0, 0.107 + 0.1034))
    assert urdf.fixed_root("panda_link7") == ("panda_link7", Pose())


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2])
def test_at_a_quarter_turn_of_pitch_the_angles_are_those_of_the_same_turn(pitch):
    turn = Pose.from_rpy((0.0, 0.0, 0.0), (0.4, pitch, 0.9))
    again = Pose.from_rpy((0.0, 0.0, 0.0), turn.rpy())
    for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        wanted = turn.compose(Pose(axis)).xyz
        assert again.compose(Pose(axis)).xyz == pytest.approx(wanted, abs=1e-6)
