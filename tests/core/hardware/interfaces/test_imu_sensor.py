"""Inertial measurement units."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces import ImuSensorHandle, ImuSensorInterface


def test_values_are_copies_of_the_robots_own():
    values = {
        "orientation": [0.0, 0.0, 0.0, 1.0],
        "orientation_covariance": [1.0] * 9,
        "angular_velocity": [1.0, 2.0, 3.0],
        "angular_velocity_covariance": [2.0] * 9,
        "linear_acceleration": [4.0, 5.0, 6.0],
        "linear_acceleration_covariance": [3.0] * 9,
    }
    handle = ImuSensorHandle("imu", "base", **values)

    handle.get_orientation()[3] = 0.0

    for name, value in values.items():
        assert getattr(handle, f"get_{name}")() == value
    assert handle.get_frame_id() == "base"


def test_every_reading_may_be_absent():
    handle = ImuSensorHandle("imu", "base")

    assert handle.get_orientation() is None
    assert handle.get_linear_acceleration_covariance() is None


def test_a_storage_that_is_too_short_is_refused():
    with pytest.raises(HardwareInterfaceError, match="Orientation"):
        ImuSensorHandle("imu", "base", orientation=[0.0, 0.0, 1.0])


def test_reading_claims_nothing():
    interface = ImuSensorInterface()
    interface.register_handle(ImuSensorHandle("imu", "base"))

    interface.get_handle("imu")

    assert interface.get_claims() == []
