"""The message with an arm's state has the arm's numbers, modes and flags."""

import pytest

from station.core.franka import RobotMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.fci.wire.robot_protocol import NO_CONTROLLER, NO_GENERATOR


def test_state_has_the_arms_numbers_modes_and_flags(client, arm):
    arm.state.q, arm.state.m_load = [0.1 * i for i in range(7)], 0.7
    tool = [*IDENTITY[:12], 0.1, 0.2, 0.3, 1.0]
    arm.state.O_T_EE = tool
    arm.state.current_errors[6] = arm.state.last_motion_errors[40] = True
    arm.state.control_command_success_rate = 0.75
    state, _ = client.cycle()

    assert list(state["q"]) == pytest.approx([0.1 * i for i in range(7)])
    assert list(state["O_T_EE"]) == tool
    assert (state["m_load"], state["message_id"]) == (0.7, 2)
    assert [i for i, flag in enumerate(state["errors"]) if flag] == [6]
    assert [i for i, flag in enumerate(state["reflex_reason"]) if flag] == [40]
    assert state["control_command_success_rate"] == 0.75
    assert state["robot_mode"] == RobotMode.IDLE.value
    assert state["motion_generator_mode"] == NO_GENERATOR
    assert state["controller_mode"] == NO_CONTROLLER
