"""Joint motion that belongs to a motion of the end effector, by finite differences."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from station.controllers.cartesian_motion.joint_lookahead import (
    ELBOW,
    ArmConfiguration,
)
from station.core.franka import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.poses import twist_between
from station.hw.franka.arm.franka_kinematics import frame_pose
from station.memory.doubles import doubles, zeros
from tests.controllers.cartesian_motion.conftest import Kinematics

Q = [0.2, -0.6, 0.3, -2.0, 0.4, 1.7, 0.5]
TWIST = [0.1, -0.2, 0.05, 0.3, 0.1, -0.4]
STEP = 1e-5


def configuration(q):
    result = ArmConfiguration(Kinematics(), RobotState(), [1.0] * 7, [1.0] * 7)
    result.move_to(doubles(q))
    return result


def twist_of(q, dq):
    ends = [
        frame_pose(Frame.END_EFFECTOR, (np.array(q) + sign * STEP * dq).tolist())
        for sign in (-1.0, 1.0)
    ]
    return twist_between(ends[0], ends[1], 2.0 * STEP)


def joint_velocities(configuration, twist):
    result = zeros(7)
    configuration.motion.write_joint_rates(doubles(twist), result)
    return np.array(result)


def test_joint_velocities_make_the_twist_and_leave_the_elbow():
    dq = joint_velocities(configuration(Q), TWIST)

    assert twist_of(Q, dq) == pytest.approx(TWIST, abs=1e-6)
    assert dq[ELBOW] == pytest.approx(0.0, abs=1e-7)


def test_a_joint_step_leads_to_the_pose_and_the_elbow():
    step, way = zeros(7), doubles([1e-4, 0.0, 2e-4, 0.0, 1e-4, 0.0])
    configuration(Q).motion.joint_step(way, Q[2] + 1e-3, step)
    q = [a + b for a, b in zip(Q, step, strict=True)]
    before, after = (frame_pose(Frame.END_EFFECTOR, each) for each in (Q, q))

    reached = twist_between(before, after, 1.0)
    assert reached == pytest.approx([1e-4, 0, 2e-4, 0, 1e-4, 0], abs=1e-6)
    assert q[ELBOW] == pytest.approx(Q[2] + 1e-3)


def test_an_arm_that_does_not_accelerate_drifts():
    kernel, drift = configuration(Q).motion, zeros(6)
    dq = joint_velocities(configuration(Q), TWIST)
    dq[ELBOW] = 0.3
    kernel.drift(doubles(dq), drift)
    before, after = (
        twist_of((np.array(Q) + t * dq).tolist(), dq) for t in (-1e-3, 1e-3)
    )

    found = (np.array(after) - np.array(before)) / 2e-3
    assert found == pytest.approx(np.array(drift), abs=1e-4)
    assert np.abs(found).max() > 0.05


@pytest.mark.parametrize("which", range(3))
def test_the_joint_that_exceeds_its_bounds_most_is_found(which):
    wanted = [0.3, -0.1, 0.2, 0.5, -0.2, 0.1]
    accelerations = [[0.0] * 6, [0.0] * 6]
    if which < 2:
        accelerations[which] = wanted
    kernel, drift = configuration(Q).motion, zeros(6)
    dq = joint_velocities(configuration(Q), TWIST)
    kernel.drift(doubles(dq), drift)
    needed = [
        np.abs(joint_velocities(configuration(Q), np.subtract(each, drift)))
        for each in ([0.0] * 6, *accelerations)
    ]

    def fastest(velocity, acceleration):
        kernel.velocity, kernel.acceleration = doubles(velocity), doubles(acceleration)
        return kernel.fastest_joint(
            doubles(TWIST), doubles(accelerations[0] + accelerations[1])
        )

    largest, far = np.max(needed, axis=0), [1e9] * 7
    assert fastest(np.abs(dq) * 1.01 + 1e-6, largest * 1.01 + 1e-6) == -1
    assert fastest(far, largest * 0.99 + 1e-6) >= 0
    for joint in (0, 1, 3, 4, 5, 6):
        bounds = [1e9] * 7
        bounds[joint] = 0.99 * largest[joint]
        assert fastest(far, bounds) == joint
        bounds[joint] = 0.99 * abs(dq[joint])
        assert fastest(bounds, far) == joint


def test_a_configuration_places_the_end_effector_and_moves_on():
    it, pose = configuration(Q), zeros(16)
    it.place(pose)
    assert [*pose] == frame_pose(Frame.END_EFFECTOR, Q)
    there = [value + 0.1 for value in Q]
    it.move_to(doubles(there))
    it.place(pose)

    assert [*pose] == frame_pose(Frame.END_EFFECTOR, there)
    moved, new = zeros(7), zeros(7)
    it.motion.write_joint_rates(doubles(TWIST), moved)
    configuration(there).motion.write_joint_rates(doubles(TWIST), new)
    assert [*moved] == [*new]


def test_a_stretched_arm_has_no_dexterity():
    assert configuration(Q).dexterity() > 0.1
    assert configuration([0.0] * 7).dexterity() < 1e-6
    assert configuration(Q).motion.is_dexterous(0.05)
    assert not configuration([0.0] * 7).motion.is_dexterous(0.01)
    assert not configuration(Q).motion.is_dexterous(1.0)


@given(st.lists(st.floats(-2.5, 2.5), min_size=7, max_size=7), st.floats(0.01, 1.0))
def test_an_arm_is_called_dexterous_only_if_it_is(q, least):
    it = configuration(q)

    if it.motion.is_dexterous(least):
        assert it.dexterity() > least
    # The column of joint 3 is counted for more than it is.
    else:
        assert it.dexterity() < 4.0 * least
