"""Poses against products of matrices, Jacobians against finite differences."""

import numpy as np
import pytest
from hypothesis import given

from station.core.numerics.arm_chain import JointChain
from station.memory.doubles import doubles
from tests.both_modes import arrays, assert_same, needs_both


def pose_of(vector, moved):
    """Return a pose from a rotation vector and a translation."""
    angle = np.linalg.norm(vector)
    pose = np.eye(4)
    if angle:
        x, y, z = np.asarray(vector) / angle
        skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        pose[:3, :3] += np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew
    pose[:3, 3] = moved
    return pose


RNG = np.random.default_rng(4)
ORIGINS = [pose_of(RNG.normal(size=3), RNG.normal(size=3)) for _ in range(5)]
AXES = [axis / np.linalg.norm(axis) for axis in RNG.normal(size=(4, 3))]
TURNS = [1.0, 0.0, 1.0, 1.0]
INDICES = [2, 0, 4, 3]
Q = RNG.normal(size=5)


def chain():
    flat = np.concatenate([pose.T.ravel() for pose in ORIGINS])
    return JointChain(5, flat.tolist(), np.ravel(AXES).tolist(), TURNS, INDICES)


def expected(q):
    pose = ORIGINS[0]
    for axis, turns, index, origin in zip(
        AXES, TURNS, INDICES, ORIGINS[1:], strict=True
    ):
        way = q[index] * axis
        step = pose_of(way, [0, 0, 0]) if turns else pose_of([0, 0, 0], way)
        pose = pose @ step @ origin
    return pose


def test_the_pose_is_the_product_of_all_poses():
    found = chain()
    found.place(doubles(Q))

    assert [*found.pose] == pytest.approx(expected(Q).T.ravel(), abs=1e-12)


@pytest.mark.parametrize("joint", range(5))
def test_the_jacobian_is_the_derivative_of_the_pose(joint):
    found = chain()
    found.place(doubles(Q))
    found.differentiate()

    step = np.zeros(5)
    step[joint] = 1e-6
    change = (expected(Q + step) - expected(Q - step)) / 2e-6
    turned = change[:3, :3] @ expected(Q)[:3, :3].T
    twist = [*change[:3, 3], turned[2, 1], turned[0, 2], turned[1, 0]]
    column = [*found.jacobian][6 * joint : 6 * joint + 6]
    assert column == pytest.approx(twist, abs=1e-8)


@needs_both
@given(arrays(5), arrays(12))
def test_both_modes_agree_bit_for_bit(q, axes):
    flat = np.concatenate([pose.T.ravel() for pose in ORIGINS]).tolist()

    def scenario(module):
        found = module.JointChain(5, flat, axes, TURNS, INDICES)
        found.place(doubles(q))
        found.differentiate()
        return [*found.pose, *found.jacobian]

    assert_same("arm_chain", scenario)
