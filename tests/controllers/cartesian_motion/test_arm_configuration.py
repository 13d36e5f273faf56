"""Joint motion that belongs to a motion of the end effector, by finite differences."""

import numpy as np
import pytest

from station.controllers.cartesian_motion.arm_configuration import (
    ELBOW,
    ArmConfiguration,
)
from station.core.franka import Frame
from station.core.numerics.rigid_motion import twist_between
from station.hw.franka.arm.franka_kinematics import frame_pose, zero_jacobian

Q = [0.2, -0.6, 0.3, -2.0, 0.4, 1.7, 0.5]
TWIST = [0.1, -0.2, 0.05, 0.3, 0.1, -0.4]
STEP = 1e-5


def configuration(q):
    return ArmConfiguration(list(q), zero_jacobian(Frame.END_EFFECTOR, q))


def twist_of(q, dq):
    ends = [
        frame_pose(Frame.END_EFFECTOR, (np.array(q) + sign * STEP * dq).tolist())
        for sign in (-1.0, 1.0)
    ]
    return twist_between(ends[0], ends[1], 2.0 * STEP)


def test_joint_velocities_make_the_twist_and_leave_the_elbow():
    dq = configuration(Q).joint_motion(TWIST, [])[0]

    assert twist_of(Q, dq) == pytest.approx(TWIST, abs=1e-6)
    assert dq[ELBOW] == pytest.approx(0.0, abs=1e-7)


def test_a_joint_step_leads_to_the_pose_and_the_elbow():
    step = configuration(Q).joint_step([1e-4, 0.0, 2e-4, 0.0, 1e-4, 0.0], Q[2] + 1e-3)
    q = [a + b for a, b in zip(Q, step, strict=True)]
    before, after = (frame_pose(Frame.END_EFFECTOR, each) for each in (Q, q))

    reached = twist_between(before, after, 1.0)
    assert reached == pytest.approx([1e-4, 0, 2e-4, 0, 1e-4, 0], abs=1e-6)
    assert q[ELBOW] == pytest.approx(Q[2] + 1e-3)


def test_joint_accelerations_keep_the_acceleration_asked_for():
    wanted = np.array([0.3, -0.1, 0.2, 0.5, -0.2, 0.1])
    dq, ddq, _ = configuration(Q).joint_motion(TWIST, [wanted])
    before, after = (
        twist_of(
            (np.array(Q) + t * dq + 0.5 * t * t * ddq).tolist(), np.array(dq + t * ddq)
        )
        for t in (-1e-3, 1e-3)
    )

    found = (np.array(after) - np.array(before)) / 2e-3
    assert found == pytest.approx(wanted, abs=1e-4)


def test_accelerations_without_any_of_the_end_effector_come_last():
    motion = configuration(Q).joint_motion(TWIST, [[0.0] * 6])

    assert motion[1] == pytest.approx(motion[2])
    assert max(abs(motion[2])) > 0.01


def test_a_stretched_arm_has_no_dexterity():
    assert configuration(Q).dexterity() > 0.1
    assert configuration([0.0] * 7).dexterity() < 1e-6
