"""Every joint has one slot in every list."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.hardware.transmissions import RawJointData


def test_joint_keeps_its_slot():
    raw = RawJointData()
    assert [raw.add(name) for name in ("a", "b", "a")] == [0, 1, 0]
    assert len(raw.effort_command) == 2


def test_values_are_nan_until_they_are_written():
    raw = RawJointData()
    raw.add("a")
    for values in (raw.position, raw.torque_sensor, raw.velocity_command):
        assert values[0] != values[0]  # only NaN differs from itself


def test_places_are_in_the_order_asked_for():
    raw = RawJointData()
    raw.add("a")
    raw.add("b")
    data = raw.command_data(["b", "a"], "velocity")
    assert data.velocity == [(raw.velocity_command, 1), (raw.velocity_command, 0)]
    assert data.velocity[0][0] is raw.velocity_command
    assert data.position == data.effort == []


def test_joints_named_at_the_start_lie_side_by_side_and_are_all():
    raw = RawJointData(["a", "b"])
    assert [raw.add(name) for name in ("b", "a")] == [1, 0]
    assert all(isinstance(v, memoryview) for v in (raw.position, raw.effort_command))
    assert all(value != value for value in raw.velocity)  # NaN until it is written
    with pytest.raises(HardwareInterfaceError, match="Joint 'c' was not named"):
        raw.add("c")
    assert (raw.names, len(raw.position)) == (["a", "b"], 2)
