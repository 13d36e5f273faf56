"""The tool of an arm and the force on it."""

import math

import pytest

from station.core.description.urdf import Pose
from station.ui.link.station_view import arm_facts, pose_of

TURN = math.sqrt(0.5)
IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]


@pytest.mark.parametrize(
    "quaternion",
    [
        (1.0, 0, 0, 0),
        (0, 1.0, 0, 0),
        (0, 0, 1.0, 0),
        (0, 0, 0, 1.0),
        (TURN, 0, 0, TURN),
    ],
)
def test_a_matrix_gives_its_pose(quaternion):
    pose = Pose((1.0, 2.0, 3.0), quaternion)
    columns = [
        pose.compose(Pose(axis)).xyz for axis in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))
    ]
    matrix = []
    for column in columns:
        matrix += [*(a - b for a, b in zip(column, pose.xyz, strict=True)), 0.0]
    found = pose_of([*matrix, *pose.xyz, 1.0])
    assert found.xyz == pose.xyz
    same = sum(a * b for a, b in zip(found.quaternion, quaternion, strict=True))
    assert abs(same) == pytest.approx(1.0)


def test_the_force_on_the_arm_is_opposite_to_that_of_the_arm():
    state = {
        "F_T_EE": IDENTITY,
        "EE_T_K": IDENTITY,
        "O_F_ext_hat_K": [1.0, -2, 3, 0, 0, 0],
    }
    assert arm_facts(state).force == (-1.0, 2.0, -3.0)


def test_what_an_arm_does_not_tell_is_not_drawn():
    facts = arm_facts({"O_F_ext_hat_K": [None] * 6})
    assert facts.force is None
    assert facts.flange_to_tool == Pose()
