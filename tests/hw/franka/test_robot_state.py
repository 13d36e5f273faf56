"""The state's shape is libfranka's."""

from dataclasses import fields

from station.hw.franka.robot_state import RobotMode, RobotState


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


def test_every_list_has_seven_joints_and_belongs_to_one_state() -> None:
    first, second = RobotState(), RobotState()
    for field in fields(RobotState):
        value = getattr(first, field.name)
        if isinstance(value, list):
            assert value == [0.0] * 7
            assert value is not getattr(second, field.name)
