"""Steps of the inverse kinematics lead to the pose, and both modes."""

import pytest
from hypothesis import given, settings

from station.core.franka import Frame
from station.hw.franka.arm.franka_kinematics import CHAIN, IDENTITY, frame_pose
from station.hw.franka.simulated.cartesian_step import InverseKinematics
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

Q = [0.2, -0.6, 0.3, -2.0, 0.4, 1.7, 0.5]
TOOL = [*IDENTITY[:12], 0.0, 0.02, 0.1, 1.0]


def solve(q, target, elbow, steps):
    """Return joint positions after some steps towards a pose."""
    q, step = doubles(q), zeros(7)
    kinematics = InverseKinematics(CHAIN, q, doubles(TOOL), doubles(target), step)
    for _ in range(steps):
        kinematics.advance(elbow)
        q[:] = doubles(a + b for a, b in zip(q, step, strict=True))
    return q.tolist()


def test_steps_converge_to_pose_and_elbow():
    there = [value + 0.01 * (-1) ** joint for joint, value in enumerate(Q)]
    target = frame_pose(Frame.END_EFFECTOR, there, TOOL)

    assert solve(Q, target, there[2], 1) == pytest.approx(there, abs=1e-3)
    assert solve(Q, target, there[2], 4) == pytest.approx(there, abs=1e-9)


def test_the_elbow_moves_alone_while_the_pose_stays():
    target = frame_pose(Frame.END_EFFECTOR, Q, TOOL)
    found = solve(Q, target, Q[2] + 0.05, 5)

    assert found[2] == pytest.approx(Q[2] + 0.05)
    assert frame_pose(Frame.END_EFFECTOR, found, TOOL) == pytest.approx(target)


def test_steps_at_a_singular_pose_stay_small():
    stretched = [0.0] * 7
    target = frame_pose(Frame.END_EFFECTOR, stretched, TOOL)
    target[14] += 0.01
    found = solve(stretched, target, 0.0, 1)

    # Without the coarse damping a step of 10 rad would follow.
    assert max(map(abs, found)) < 0.2


@needs_both
@settings(max_examples=60)
@given(arrays(7), arrays(16), arrays(16), numbers)
def test_both_modes_agree_bit_for_bit(q, tool, target, elbow):
    def scenario(module):
        step = zeros(7)
        kinematics = module.InverseKinematics(
            CHAIN, doubles(q), doubles(tool), doubles(target), step
        )
        kinematics.advance(elbow)
        return step

    assert_same("cartesian_step", scenario)


@needs_both
@settings(max_examples=60)
@given(arrays(7), arrays(7))
def test_both_modes_agree_on_poses(q, there):
    def scenario(module):
        step, target = zeros(7), doubles(frame_pose(Frame.END_EFFECTOR, there, TOOL))
        kinematics = module.InverseKinematics(
            CHAIN, doubles(q), doubles(TOOL), target, step
        )
        kinematics.advance(0.1)
        return step

    assert_same("cartesian_step", scenario)
