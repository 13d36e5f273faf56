"""Cartesian handles claim the arm and rest where it is meant to be."""

import pytest

from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
    RobotState,
)


@pytest.fixture
def state():
    state = RobotState()
    state.doubles("O_T_EE_d")[12] = 0.5
    return state


def test_pose_handle_commands_pose_and_elbow(state):
    pose, elbow = [0.0] * 16, [0.0, 0.0]
    handle = FrankaCartesianPoseHandle("a_robot", state, lambda: None, pose, elbow)
    interface = FrankaPoseCartesianInterface()
    interface.register_handle(handle)

    interface.get_handle("a_robot").set_command([1.0] * 16, [0.3, -1.0])
    assert (pose, elbow) == ([1.0] * 16, [0.3, -1.0])
    handle.set_command([2.0] * 16)
    assert (handle.get_command(), elbow) == ([2.0] * 16, [0.0, 0.0])
    assert interface.get_claims() == ["a_robot"]
    assert interface.rest_commands("a_robot") == state.O_T_EE_d
    assert len(handle.command_slots()) == len(interface.start_jump_limits("x")) == 16


def test_twist_rests_at_zero(state):
    twist, elbow = [1.0] * 6, [0.0, 0.0]
    interface = FrankaVelocityCartesianInterface()
    interface.register_handle(
        FrankaCartesianVelocityHandle("a_robot", state, lambda: None, twist, elbow)
    )

    assert interface.rest_commands("a_robot") == [0.0] * 6
    assert len(interface.start_jump_limits("a_robot")) == 6
