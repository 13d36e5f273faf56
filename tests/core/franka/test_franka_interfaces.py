"""Cartesian handles claim the arm and rest where it is meant to be."""

import pytest

from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
    RobotState,
)
from station.memory.doubles import doubles, zeros


@pytest.fixture
def state():
    state = RobotState()
    state.doubles("O_T_EE_d")[12] = 0.5
    return state


def test_pose_handle_commands_pose_and_elbow(state):
    pose, elbow = zeros(16), zeros(2)
    handle = FrankaCartesianPoseHandle("a_robot", state, lambda: None, pose, elbow)
    interface = FrankaPoseCartesianInterface()
    interface.register_handle(handle)

    interface.get_handle("a_robot").set_command([1.0] * 16, [0.3, -1.0])
    assert (pose.tolist(), elbow.tolist()) == ([1.0] * 16, [0.3, -1.0])
    handle.set_command([2.0] * 16)
    assert (handle.get_command(), elbow.tolist()) == ([2.0] * 16, [0.0, 0.0])
    assert interface.get_claims() == ["a_robot"]
    assert interface.rest_commands("a_robot") == state.O_T_EE_d
    assert len(handle.command_slots()) == len(interface.start_jump_limits("x")) == 16


def test_twist_rests_at_zero(state):
    twist, elbow = doubles([1.0] * 6), zeros(2)
    interface = FrankaVelocityCartesianInterface()
    interface.register_handle(
        FrankaCartesianVelocityHandle("a_robot", state, lambda: None, twist, elbow)
    )

    assert interface.rest_commands("a_robot") == [0.0] * 6
    assert len(interface.start_jump_limits("a_robot")) == 6
