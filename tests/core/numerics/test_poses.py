"""Poses, rotation vectors, twists and quaternions."""

from math import pi

import numpy as np
import pytest

from station.core.numerics.arm_chain import turn_to_inner_axes
from station.core.numerics.poses import (
    displace,
    pose_of,
    quaternion_of,
    rotation_between,
    times,
    to_outer_axes,
    twist_between,
)
from station.memory.doubles import doubles

IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]
TURNS = [
    [0.3, -0.2, 0.9],
    [1e-7, 0.0, 0.0],
    [0.0, 0.0, 3.1],
    [pi / 2, 0.0, 0.0],
]


@pytest.mark.parametrize("turn", TURNS)
def test_rotation_vector_is_recovered(turn):
    base = displace(IDENTITY, [0.1, 0.2, 0.3], [0.4, 0.5, -0.6])
    moved = displace(base, [0.0, 0.0, 0.0], turn)
    assert rotation_between(base, moved) == pytest.approx(turn, abs=1e-9)


def test_half_a_turn_has_an_axis():
    moved = displace(IDENTITY, [0.0] * 3, [0.0, pi, 0.0])
    assert np.abs(rotation_between(IDENTITY, moved)) == pytest.approx([0.0, pi, 0.0])


def test_twist_leads_there():
    moved = displace(IDENTITY, [0.001, 0.0, 0.0], [0.0, 0.002, 0.0])
    assert twist_between(IDENTITY, moved, 0.001) == pytest.approx([1, 0, 0, 0, 2, 0])


def test_displaced_rotation_is_exact():
    pose = list(IDENTITY)
    for _ in range(10_000):
        pose = displace(pose, [0.0] * 3, [1e-3, 2e-3, -1e-3])
    rotation = np.reshape(pose, (4, 4))[:3, :3]
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-12)


# Each of the four numbers is the largest once; half turns among them.
QUATERNIONS = [
    [0.1, -0.2, 0.3, 0.9],
    [0.9, 0.3, -0.2, 0.1],
    [-0.3, 0.9, 0.2, 0.0],
    [0.2, 0.1, -0.9, 0.3],
    [1.0, 0.0, 0.0, 0.0],
]


@pytest.mark.parametrize("quaternion", QUATERNIONS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_quaternion_and_its_negative_are_the_same_pose(quaternion, sign):
    unit = np.array(quaternion) / np.linalg.norm(quaternion)
    pose = pose_of([0.1, 0.2, 0.3], (sign * unit).tolist())

    assert abs(np.dot(quaternion_of(pose), unit)) == pytest.approx(1.0, abs=1e-12)
    assert quaternion_of(pose)[3] >= 0.0
    assert pose[12:] == [0.1, 0.2, 0.3, 1.0]


def test_a_quaternion_turns_as_its_rotation_vector_does():
    turn = [0.3, -0.2, 0.9]
    angle = float(np.linalg.norm(turn))
    axis = np.array(turn) / angle
    quaternion = [*(np.sin(angle / 2.0) * axis).tolist(), np.cos(angle / 2.0)]

    turned = displace(IDENTITY, [0.0] * 3, turn)
    assert pose_of([0.0] * 3, quaternion) == pytest.approx(turned, abs=1e-12)
    assert quaternion_of(turned) == pytest.approx(quaternion, abs=1e-12)


def test_a_vector_of_the_end_effector_is_turned_to_the_base():
    pose = displace(IDENTITY, [1.0, 2.0, 3.0], [0.0, 0.0, pi / 2])

    assert to_outer_axes(pose, [1.0, 0.0, 2.0]) == pytest.approx([0.0, 1.0, 2.0])
    vector = doubles([0.0, 1.0, 2.0])
    turn_to_inner_axes(doubles(pose), vector, vector)
    assert [*vector] == pytest.approx([1.0, 0.0, 2.0])


def test_jacobian_times_velocity():
    jacobian = np.arange(42.0)
    dq = [1.0, 0.0, -2.0, 0.0, 0.0, 0.5, 0.0]
    expected = np.reshape(jacobian, (7, 6)).T @ dq
    assert times(jacobian.tolist(), dq) == pytest.approx(expected)
