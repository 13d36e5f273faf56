"""Derived fields against the kinematics, and both modes."""

import numpy as np
import pytest
from hypothesis import given, settings

from station.core.franka import Frame, RobotState
from station.hw.franka.arm.franka_kinematics import CHAIN, frame_pose, zero_jacobian
from station.hw.franka.simulated import cartesian_step
from station.memory.doubles import put
from tests.both_modes import arrays, assert_same, needs_both

Q = [0.2, -0.6, 0.3, -2.0, 0.4, 1.7, 0.5]
DERIVED = (
    "O_T_EE", "O_T_EE_d", "O_T_EE_c", "O_dP_EE_d", "O_dP_EE_c", "O_ddP_EE_c",
    "elbow", "elbow_d", "elbow_c", "delbow_c", "ddelbow_c",
)  # fmt: skip


def state_of(module, q, q_d, dq_d, ddq_d):
    state = RobotState(q=q, q_d=q_d, dq_d=dq_d, ddq_d=ddq_d)
    return state, module.EndEffectorState(state.doubles, CHAIN)


def test_poses_twists_and_elbows_follow_the_joints():
    there, rates = [value + 0.1 for value in Q], [0.1 * joint for joint in range(7)]
    state, kernel = state_of(cartesian_step, Q, there, rates, [0.5] * 7)
    kernel.refresh()

    jacobian = np.reshape(zero_jacobian(Frame.END_EFFECTOR, there), (7, 6))
    assert frame_pose(Frame.END_EFFECTOR, Q) == state.O_T_EE
    assert state.O_T_EE_d == frame_pose(Frame.END_EFFECTOR, there)
    assert state.O_dP_EE_d == pytest.approx((rates @ jacobian).tolist())
    assert (state.elbow, state.elbow_d) == ([0.3, -1.0], [0.4, -1.0])
    assert state.O_T_EE_c == RobotState().O_T_EE_c


def test_commanded_fields_may_follow_the_desired_ones():
    state, kernel = state_of(cartesian_step, Q, Q, [0.1] * 7, [0.5] * 7)
    kernel.refresh()
    kernel.command_desired()

    assert (state.O_T_EE_c, state.O_dP_EE_c) == (state.O_T_EE_d, state.O_dP_EE_d)
    assert state.O_ddP_EE_c == [0.0] * 6
    assert (state.elbow_c, state.delbow_c) == (state.elbow_d, [0.1, 0.0])
    assert state.ddelbow_c == [0.5, 0.0]


def test_a_joint_motion_in_progress_has_an_acceleration():
    state, kernel = state_of(cartesian_step, Q, Q, [0.1] * 7, [0.5] * 7)
    kernel.command_joint_motion()

    jacobian = np.reshape(zero_jacobian(Frame.END_EFFECTOR, Q), (7, 6))
    assert state.O_ddP_EE_c == pytest.approx((np.full(7, 0.5) @ jacobian).tolist())


@needs_both
@settings(max_examples=60)
@given(arrays(7), arrays(7), arrays(7), arrays(16))
def test_both_modes_agree_bit_for_bit(q, q_d, rates, tool):
    def scenario(module):
        state, kernel = state_of(module, q, q_d, rates, rates)
        put(state.doubles("F_T_EE"), tool)
        kernel.refresh()
        kernel.command_desired()
        found = [value for name in DERIVED for value in getattr(state, name)]
        kernel.command_joint_motion()
        return [*found, *state.O_ddP_EE_c]

    assert_same("cartesian_step", scenario)
