"""Commands are followed once each, and missed ones are made up for."""

from dataclasses import replace
from math import inf

import pytest

from station.core.errors import InvalidCommandError
from station.core.franka import RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.robot_arm import MotionGeneratorMode
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.hw.franka.simulated.arm_cycle import ArmCycle
from station.hw.franka.simulated.motion_follower import MotionFollower
from station.hw.mujoco.simulator_memory import SimulatorMemory

PERIOD = 0.001
Q = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]


@pytest.fixture
def state() -> RobotState:
    return RobotState(q_d=list(Q), control_command_success_rate=1.0)


@pytest.fixture
def follower(state: RobotState) -> MotionFollower:
    limits = replace(PANDA_LIMITS, lower=(-inf,) * 7, upper=(inf,) * 7)
    memory = SimulatorMemory(7)
    cycle = ArmCycle(state, limits, SupervisorLimits(), memory, PERIOD)
    follower = MotionFollower(state, cycle, PANDA_LIMITS, PERIOD)
    follower.begin(MotionGeneratorMode.JOINT_VELOCITY)
    return follower


def test_nothing_happens_before_the_first_command(follower, state):
    for _ in range(100):
        assert follower.advance(torques_act=False, is_lossy=False) == []
    assert not follower._step.is_begun
    assert state.q_d == Q
    assert state.control_command_success_rate == 1.0


def test_missed_command_keeps_the_acceleration(follower, state):
    for cycle in range(1, 4):
        follower.command_joints([0.003 * cycle] * 7)
        follower.advance(torques_act=False, is_lossy=False)
    follower.command_joints([0.012] * 7)
    assert follower.advance(torques_act=False, is_lossy=True) == []
    assert state.dq_d == pytest.approx([0.012] * 7)
    assert state.control_command_success_rate == pytest.approx(0.99)


def test_losses_are_forgotten_after_a_hundred_cycles(follower, state):
    for cycle in range(150):
        follower.command_joints([0.0] * 7)
        follower.advance(torques_act=False, is_lossy=cycle in {10, 20})
    assert state.control_command_success_rate == 1.0


def test_lost_torques_repeat_the_last_ones(follower):
    follower.begin(MotionGeneratorMode.NONE)
    follower.command_torques([0.5] * 7)
    follower.advance(torques_act=True, is_lossy=False)
    follower.command_torques([0.9] * 7)
    follower.advance(torques_act=True, is_lossy=True)
    assert list(follower._memory.torques) == [0.5] * 7


def test_malformed_commands_are_refused(follower):
    with pytest.raises(InvalidCommandError, match="7 finite"):
        follower.command_joints([0.0] * 6)
    with pytest.raises(InvalidCommandError, match="16 finite"):
        follower.command_cartesian([0.0] * 6, None, 16)
    with pytest.raises(InvalidCommandError, match="elbow"):
        follower.command_cartesian([0.0] * 6, [0.1, 0.5], 6)
