"""A state handle shows the live state, refreshed."""

from station.core.franka import FrankaStateHandle, FrankaStateInterface, RobotState


def test_state_is_refreshed_when_asked_for():
    state, asked = RobotState(), []
    interface = FrankaStateInterface()
    interface.register_handle(
        FrankaStateHandle("a_robot", state, lambda: asked.append(1))
    )

    handle = interface.get_handle("a_robot")

    assert handle.get_robot_state() is state
    assert asked == [1]
    assert interface.get_claims() == []
    assert handle.command_slots() == []
