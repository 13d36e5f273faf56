"""The 41 flags have libfranka's names and order."""

from station.core.franka.franka_errors import (
    ERROR_INDEX,
    ERROR_NAMES,
    ArmError,
    error_names,
)


def test_flags_are_in_the_order_of_libfranka():
    assert len(ERROR_NAMES) == len(set(ERROR_NAMES)) == 41
    assert ERROR_INDEX["joint_reflex"] == 6
    assert ERROR_INDEX["cartesian_reflex"] == 7
    assert ERROR_INDEX["communication_constraints_violation"] == 25
    assert ERROR_INDEX["controller_torque_discontinuity"] == 32
    assert ERROR_INDEX["base_acceleration_invalid_reading"] == 40


def test_flags_that_are_set_are_named():
    flags = [False] * 41
    flags[6] = flags[32] = True
    assert error_names(flags) == ["joint_reflex", "controller_torque_discontinuity"]


def test_error_without_a_place_is_described():
    error = ArmError("power_limit_violation", "", 500.0, 400.0, "W", 3)
    assert error.description == (
        "power_limit_violation: 500 W, allowed is 400 W (cycle 3)"
    )
