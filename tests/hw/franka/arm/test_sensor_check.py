"""Readings that are no numbers are named."""

from math import inf, nan

import pytest

from station.core.franka import RobotState
from station.hw.franka.arm.sensor_check import SensorCheck


def test_finite_readings_are_fine():
    state = RobotState()
    state.doubles("tau_J")[0] = -87.0
    assert SensorCheck(state).readings.first_bad() == -1


@pytest.mark.parametrize(
    ("field", "joint", "value", "text"),
    [
        ("q", 2, nan, "the position of joint2 reads nan"),
        ("dq", 7, inf, "the velocity of joint7 reads inf"),
        ("tau_J", 1, -inf, "the torque of joint1 reads -inf"),
    ],
)
def test_sensor_without_a_number_is_named(field, joint, value, text):
    state = RobotState()
    state.doubles(field)[joint - 1] = value
    check = SensorCheck(state)
    assert check.describe(check.readings.first_bad()) == text
