"""Actuator handles read and command like joint handles, and claim nothing."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces.actuator import (
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    PositionActuatorInterface,
    VelocityActuatorInterface,
)

COMMAND_INTERFACES = [
    EffortActuatorInterface,
    VelocityActuatorInterface,
    PositionActuatorInterface,
]


def make_state():
    return ActuatorStateHandle("motor", [1.0], [2.0], [3.0], absolute_position=[4.0])


def test_state_is_read_from_the_slots():
    state = make_state()
    values = (state.get_position(), state.get_velocity(), state.get_effort())
    assert values == (1.0, 2.0, 3.0)
    assert state.get_absolute_position() == 4.0
    assert not state.has_torque_sensor()


def test_command_is_written_to_its_slot():
    command = [0.0]
    ActuatorHandle(make_state(), command).set_command(7.0)
    assert command == [7.0]


def test_missing_storage_is_refused_with_the_original_words():
    with pytest.raises(
        HardwareInterfaceError,
        match=r"Cannot create handle 'motor'. Command data pointer is null.",
    ):
        ActuatorHandle(make_state(), None)


@pytest.mark.parametrize("interface_type", COMMAND_INTERFACES)
def test_command_interfaces_claim_nothing(interface_type):
    interface = interface_type()
    interface.register_handle(ActuatorHandle(make_state(), [0.0]))
    interface.get_handle("motor")
    assert interface.get_claims() == []


def test_state_interface_claims_nothing():
    interface = ActuatorStateInterface()
    interface.register_handle(make_state())
    interface.get_handle("motor")
    assert interface.get_claims() == []
