"""Poses and rotation vectors."""

from math import pi

import numpy as np
import pytest

from station.core.errors import InvalidCommandError
from station.hw.franka.franka_kinematics import IDENTITY
from station.hw.franka.rigid_motion import (
    check_transform,
    displace,
    rotation_between,
    times,
    transform_problem,
    twist_between,
)

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


@pytest.mark.parametrize(
    ("index", "value", "problem"),
    [
        (15, 2.0, "last row"),
        (3, 1e-9, "last row"),
        (0, 1.00002, "length 1"),
        (12, float("nan"), "finite"),
    ],
)
def test_what_is_no_transform_is_told(index, value, problem):
    pose = list(IDENTITY)
    pose[index] = value
    assert problem in transform_problem(pose)
    with pytest.raises(InvalidCommandError, match=problem):
        check_transform(pose, "X")


def test_small_deviations_pass():
    # 0.7071 instead of the root of 1/2, as configurations have it.
    pose = [0.7071, -0.7071, 0, 0, 0.7071, 0.7071, 0, 0, *IDENTITY[8:]]
    assert transform_problem(pose) == ""


def test_jacobian_times_velocity():
    jacobian = np.arange(42.0)
    dq = [1.0, 0.0, -2.0, 0.0, 0.0, 0.5, 0.0]
    expected = np.reshape(jacobian, (7, 6)).T @ dq
    assert times(jacobian.tolist(), dq) == pytest.approx(expected)
