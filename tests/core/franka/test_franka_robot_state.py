"""The state's shape is libfranka's."""

from dataclasses import fields

from station.core.franka.franka_robot_state import RobotMode, RobotState


def test_modes_have_libfrankas_numbers() -> None:
    assert [mode.name for mode in sorted(RobotMode, key=lambda mode: mode.value)] == [
        "OTHER",
        "IDLE",
        "MOVE",
        "GUIDING",
        "REFLEX",
        "USER_STOPPED",
        "AUTOMATIC_ERROR_RECOVERY",
    ]
    assert RobotMode.OTHER.value == 0


def test_lists_belong_to_one_state() -> None:
    first, second = RobotState(), RobotState()
    for field in fields(RobotState):
        value = getattr(first, field.name)
        if isinstance(value, list):
            assert value == getattr(second, field.name)
            assert value is not getattr(second, field.name)


def test_copy_does_not_change_with_the_state() -> None:
    state = RobotState()
    copy = state.copy()
    state.doubles("q")[0] = state.time = 1.0
    state.current_errors[3] = True
    assert copy == RobotState()
    assert state.copy() == state


def test_sizes_are_libfrankas() -> None:
    state = RobotState()
    assert len(state.O_T_EE) == 16
    assert len(state.K_F_ext_hat_K) == len(state.O_dP_EE_d) == 6
    assert len(state.I_total) == 9
    assert len(state.current_errors) == 41


def test_a_packed_state_is_unpacked_as_it_was():
    state = RobotState()
    for index, each in enumerate(fields(state)):
        value = getattr(state, each.name)
        if isinstance(value, list) and isinstance(value[0], float):
            setattr(state, each.name, [index + 0.1 * i for i in range(len(value))])
        elif isinstance(value, float):
            setattr(state, each.name, index + 0.5)
    state.robot_mode = RobotMode.REFLEX
    state.current_errors = [i % 3 == 0 for i in range(len(state.current_errors))]
    state.last_motion_errors = [i % 2 == 0 for i in range(len(state.current_errors))]
    packed, copy = state.packed(), state.copy()
    put_back = RobotState.unpacked(packed)
    state.q = [9.0] * 7

    assert put_back == copy
    assert put_back.robot_mode is RobotMode.REFLEX
    assert put_back != state
