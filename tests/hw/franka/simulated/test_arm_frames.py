"""Frames, load composition and elbow against published values."""

import pytest

from station.core.franka import RobotState
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.simulated.arm_parts import ArmFrames
from station.hw.franka.simulated.cartesian_step import MAX_EXTENSION


def shifted(z: float) -> list[float]:
    return [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, z, 1.0]


@pytest.mark.parametrize(
    ("q4", "sign"), [(-2.0, -1.0), (-0.1, 1.0), (MAX_EXTENSION, 0.0)]
)
def test_elbow_is_joint_three_and_the_flip_of_joint_four(q4: float, sign: float):
    state = RobotState(time=1.0, q=[0, 0, 0.4, q4, 0, 0, 0])
    ArmFrames(state).refresh()

    assert state.elbow == [0.4, sign]


def test_loads_are_composed():
    state = RobotState()
    frames = ArmFrames(state)
    frames.set_end_effector(RigidBody(0.73, (-0.01, 0.0, -0.03)), shifted(0.1))
    frames.set_load(RigidBody(0.5, (0.01, -0.2, 0.03)))

    assert state.m_total == pytest.approx(1.23)
    assert state.F_x_Ctotal == pytest.approx(
        [-0.0018699, -0.0813008, -0.0056098], abs=1e-7
    )


def test_end_effector_frame_is_composed():
    state = RobotState()
    frames = ArmFrames(state)
    frames.set_end_effector(RigidBody(), shifted(0.1))
    frames.set_frame(shifted(0.05))
    assert state.F_T_EE[14] == pytest.approx(0.15)


def test_refresh_works_once_per_time():
    state = RobotState(time=1.0)
    frames = ArmFrames(state)
    frames.refresh()
    before = list(state.O_T_EE)
    state.doubles("q")[0] = 1.0
    frames.refresh()
    assert before == state.O_T_EE
    state.time = 2.0
    state.doubles("dq_d")[2] = 0.5
    frames.refresh()
    assert before != state.O_T_EE
    assert state.delbow_c == [0.5, 0.0]
