"""Rotations against pinocchio, and both modes against each other."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, strategies as st

from station.core.numerics.rigid_motion import (
    compose,
    displace,
    numbers_of,
    quaternion_of,
    rotation_between,
    twist_between,
)
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

IDENTITY = np.eye(4).ravel().tolist()
ways = st.lists(st.floats(-1.7, 1.7), min_size=6, max_size=6)


def pose(way):
    result = zeros(16)
    displace(doubles(IDENTITY), doubles(way), 1.0, result)
    return result


def matrix(values):
    return np.reshape(values, (4, 4)).T


@given(ways)
def test_a_rotation_vector_makes_the_rotation_of_the_exponential(way):
    found = matrix(pose(way))

    assert found[:3, :3] == pytest.approx(pin.exp3(np.array(way[3:])), abs=1e-14)
    assert found[:3, 3] == pytest.approx(way[:3])


@given(ways, ways)
def test_poses_compose_as_matrices(first, second):
    result = zeros(16)
    compose(pose(first), pose(second), result)

    wanted = matrix(pose(first)) @ matrix(pose(second))
    assert matrix(result) == pytest.approx(wanted, abs=1e-14)


@given(ways, ways, st.floats(0.001, 10.0))
def test_a_displacement_by_the_twist_leads_from_pose_to_pose(first, second, period):
    a, b, twist, back = pose(first), pose(second), zeros(6), zeros(16)
    twist_between(a, b, period, twist)
    displace(a, twist, period, back)

    assert back.tolist() == pytest.approx(b.tolist(), abs=1e-7)


@pytest.mark.parametrize("axis", [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, 0.8]])
@pytest.mark.parametrize("short_of", [0.0, 1e-12, 1e-8, 1e-4])
def test_half_a_turn_has_its_axis_and_angle(axis, short_of):
    angle, turn = np.pi - short_of, zeros(3)
    way = [0.0, 0.0, 0.0, *(angle * value for value in axis)]
    rotation_between(doubles(IDENTITY), pose(way), turn)

    found = np.array(turn)
    assert np.linalg.norm(found) == pytest.approx(angle, abs=1e-8)
    assert abs(found @ axis) == pytest.approx(angle, abs=1e-8)


@given(ways)
def test_a_quaternion_is_that_of_the_rotation(way):
    result = zeros(4)
    quaternion_of(pose(way), result)

    wanted = pin.Quaternion(pin.exp3(np.array(way[3:]))).coeffs()
    wanted = -wanted if wanted[3] < 0.0 else wanted
    assert result[3] >= 0.0
    assert abs(wanted @ np.array(result)) == pytest.approx(1.0)


@needs_both
@given(arrays(16), arrays(16), arrays(6), numbers)
def test_both_modes_agree_bit_for_bit(first, second, way, share):
    def scenario(module):
        out = [zeros(16), zeros(3), zeros(6), zeros(16), zeros(4)]
        a, b = doubles(first), doubles(second)
        module.compose(a, b, out[0])
        module.rotation_between(a, b, out[1])
        module.twist_between(a, b, 0.001, out[2])
        module.displace(a, doubles(way), share, out[3])
        module.quaternion_of(a, out[4])
        return [value for each in out for value in each]

    assert_same("rigid_motion", scenario)


@needs_both
@given(ways, ways)
def test_both_modes_agree_on_poses(first, second):
    def scenario(module):
        a, b, back, turn = zeros(16), zeros(16), zeros(16), zeros(3)
        module.displace(doubles(IDENTITY), doubles(first), 1.0, a)
        module.displace(a, doubles(second), 1.0, b)
        module.compose(a, b, back)
        module.rotation_between(a, b, turn)
        return [*a, *b, *back, *turn]

    assert_same("rigid_motion", scenario)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_numbers_of_a_pose_have_the_quaternion_nearer_to_another(sign):
    # A quarter of a turn about z, at 1 2 3.
    pose = doubles([0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1])
    found = zeros(7)
    numbers_of(pose, doubles([0.0, 0.0, 0.1, sign]), found)
    half = sign * np.sqrt(0.5)
    assert [*found] == pytest.approx([1.0, 2.0, 3.0, 0.0, 0.0, half, half])
