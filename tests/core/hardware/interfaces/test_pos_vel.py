"""Joints that are commanded by several values at once."""

import math

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces import (
    JointStateHandle,
    PositionVelocityTorqueGainsJointHandle,
    PositionVelocityTorqueGainsJointInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
)

FAMILY = [
    (PosVelJointHandle, PosVelJointInterface, 2),
    (PosVelAccJointHandle, PosVelAccJointInterface, 3),
    (
        PositionVelocityTorqueGainsJointHandle,
        PositionVelocityTorqueGainsJointInterface,
        5,
    ),
]
MISSING = [
    (PosVelJointHandle, 0, "Command position pointer is null."),
    (PosVelJointHandle, 1, "Command velocity  pointer is null."),
    (PosVelAccJointHandle, 2, "Command acceleration data pointer is null."),
    (
        PositionVelocityTorqueGainsJointHandle,
        2,
        "Command effort data pointer is null.",
    ),
    (
        PositionVelocityTorqueGainsJointHandle,
        3,
        "Command position gain data pointer is null.",
    ),
    (
        PositionVelocityTorqueGainsJointHandle,
        4,
        "Command derivative gain data pointer is null.",
    ),
]
SIZES = {handle: size for handle, _, size in FAMILY}


@pytest.fixture
def state():
    return JointStateHandle("j", [0.0, 1.5], [0.0, 0.0], [0.0, 0.0], 1)


@pytest.mark.parametrize(("handle_type", "size"), SIZES.items())
def test_all_values_are_commanded_at_once(state, handle_type, size):
    storages = [[0.0, 0.0] for _ in range(size)]
    handle = handle_type(state, *storages)
    values = [float(number + 1) for number in range(size)]

    handle.set_command(*values)

    assert [storage[1] for storage in storages] == values
    assert handle.get_command_position() == 1.0
    assert handle.get_command_velocity() == 2.0
    assert handle.get_position() == 1.5
    assert handle.command_slots() == [(storage, 1) for storage in storages]


def test_further_values_are_read_back(state):
    storages = [[0.0, 0.0] for _ in range(5)]
    PosVelAccJointHandle(state, *storages[:3]).set_command_acceleration(4.0)
    assert PosVelAccJointHandle(state, *storages[:3]).get_command_acceleration() == 4.0
    handle = PositionVelocityTorqueGainsJointHandle(state, *storages)

    handle.set_command(1.0, 2.0, 3.0, 4.0, 5.0)

    assert handle.get_command_effort() == 3.0
    assert handle.get_command_kp() == 4.0
    assert handle.get_command_kd() == 5.0


@pytest.mark.parametrize(("handle_type", "missing", "words"), MISSING)
def test_missing_data_is_refused_as_in_the_original(state, handle_type, missing, words):
    storages = [[0.0, 0.0] for _ in range(SIZES[handle_type])]
    storages[missing] = None

    with pytest.raises(HardwareInterfaceError) as caught:
        handle_type(state, *storages)

    assert str(caught.value) == f"Cannot create handle 'j'. {words}"


@pytest.mark.parametrize(("handle_type", "interface_type", "size"), FAMILY)
def test_a_joint_is_claimed_and_rests_at_its_position(
    state, handle_type, interface_type, size
):
    interface = interface_type()
    interface.register_handle(handle_type(state, *([9.0, 9.0] for _ in range(size))))
    interface.get_handle("j")

    assert interface.get_claims() == ["j"]
    assert interface.rest_commands("j")[:2] == [1.5, 0.0]
    assert len(interface.rest_commands("j")) == size
    assert len(interface.start_jump_limits("j")) == size
    assert interface_type.type_name == f"hardware_interface::{interface_type.__name__}"


def test_a_joint_at_rest_keeps_its_gains(state):
    interface = PositionVelocityTorqueGainsJointInterface()
    storages = [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 30.0], [0.0, math.nan]]
    interface.register_handle(PositionVelocityTorqueGainsJointHandle(state, *storages))

    assert interface.rest_commands("j") == [1.5, 0.0, 0.0, 30.0, 0.0]
