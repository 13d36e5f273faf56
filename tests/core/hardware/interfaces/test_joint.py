"""Joint handles read and write the robot's own lists.

Actuator handles read and command like joint handles, and claim nothing. Joint modes
have the numbers and names of the original.
"""

import pytest

from station.core.errors import HardwareInterfaceError, InvalidCommandError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandMode,
    JointHandle,
    JointModeHandle,
    JointModeInterface,
    JointStateHandle,
    PositionJointInterface,
    PosVelJointHandle,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.joint import (
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    PositionActuatorInterface,
    VelocityActuatorInterface,
)
from station.memory.doubles import doubles, zeros


@pytest.fixture
def storage():
    return [1.0, 2.0], [3.0, 4.0], [5.0, 6.0]


def test_a_state_handle_reads_its_slot(storage):
    handle = JointStateHandle("j", *storage, 1)
    storage[0][1] = 7.0

    assert handle.name == "j"
    values = (handle.get_position(), handle.get_velocity(), handle.get_effort())
    assert values == (7.0, 4.0, 6.0)


@pytest.mark.parametrize(
    ("missing", "what"), [(0, "Position"), (1, "Velocity"), (2, "Effort")]
)
def test_a_state_handle_without_data_is_refused(storage, missing, what):
    lists = list(storage)
    lists[missing] = None

    with pytest.raises(HardwareInterfaceError) as caught:
        JointStateHandle("j", *lists)

    assert (
        str(caught.value) == f"Cannot create handle 'j'. {what} data pointer is null."
    )


def test_absolute_position_and_torque_sensor_are_optional(storage):
    handle = JointStateHandle("j", *storage)

    assert not handle.has_absolute_position()
    assert not handle.has_torque_sensor()
    with pytest.raises(HardwareInterfaceError, match="no absolute"):
        handle.get_absolute_position()
    with pytest.raises(HardwareInterfaceError, match="no torque sensor"):
        handle.get_torque_sensor()


def test_absolute_position_and_torque_sensor_are_read(storage):
    handle = JointStateHandle(
        "j", *storage, 1, absolute_position=[0.0, 8.0], torque_sensor=[0.0, 9.0]
    )

    assert handle.has_absolute_position()
    assert handle.has_torque_sensor()
    assert handle.get_absolute_position() == 8.0
    assert handle.get_torque_sensor() == 9.0


def test_a_joint_handle_commands_its_slot(storage):
    command = [0.0, 0.0]
    handle = JointHandle(JointStateHandle("j", *storage, 1), command)

    handle.set_command(2.5)

    assert command == [0.0, 2.5]
    assert handle.get_command() == 2.5
    assert handle.get_position() == 2.0
    assert handle.command_slots() == [(command, 1)]


def test_the_command_may_be_in_another_slot(storage):
    command = [0.0]
    handle = JointHandle(JointStateHandle("j", *storage, 1), command, 0)

    handle.set_command(2.5)

    assert command == [2.5]


def test_a_joint_handle_without_command_data_is_refused(storage):
    with pytest.raises(HardwareInterfaceError) as caught:
        JointHandle(JointStateHandle("j", *storage), None)

    assert (
        str(caught.value) == "Cannot create handle 'j'. Command data pointer is null."
    )


@pytest.mark.parametrize(
    ("interface", "rest"),
    [
        (EffortJointInterface(), 0.0),
        (VelocityJointInterface(), 0.0),
        (PositionJointInterface(), 1.0),
    ],
)
def test_every_interface_knows_how_its_joints_rest(storage, interface, rest):
    interface.register_handle(JointHandle(JointStateHandle("j", *storage), [9.0]))

    assert interface.rest_commands("j") == [rest]
    assert interface.start_jump_limits("j") == [interface.start_jump]
    assert interface.start_jump > 0.0


@pytest.mark.parametrize("command", ["0.5", [0.5], None])
def test_a_command_that_is_no_number_is_refused_by_name(command):
    state = JointStateHandle("elbow", zeros(1), zeros(1), zeros(1), 0)
    commands = doubles([0.25])
    with pytest.raises(InvalidCommandError, match="must be a number") as caught:
        JointHandle(state, commands).set_command(command)
    assert f"'elbow' is {command!r}" in str(caught.value)
    with pytest.raises(InvalidCommandError, match="'elbow'"):
        PosVelJointHandle(state, commands, zeros(1)).set_command(command, 0.0)
    assert list(commands) == [0.25]


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


def test_a_mode_is_read_and_set():
    modes = [JointCommandMode.BEGIN, JointCommandMode.BEGIN]
    handle = JointModeHandle("j", modes, 1)

    handle.set_mode(JointCommandMode.MODE_EFFORT)

    assert modes == [JointCommandMode.BEGIN, JointCommandMode.MODE_EFFORT]
    assert handle.get_mode() is JointCommandMode.MODE_EFFORT


@pytest.mark.parametrize(
    ("number", "name"),
    [
        (-1, "not_operational"),
        (0, "position"),
        (1, "velocity"),
        (2, "effort"),
        (3, "other"),
        (4, "emergency_stop"),
        (5, "switching"),
        (6, "error"),
    ],
)
def test_numbers_and_names(number, name):
    handle = JointModeHandle("j", [JointCommandMode.NOMODE])

    assert handle.get_mode_name(JointCommandMode(number)) == name


def test_missing_data_is_refused_as_in_the_original():
    with pytest.raises(HardwareInterfaceError) as caught:
        JointModeHandle("j", None)

    assert str(caught.value) == (
        "Cannot create mode interface. Mode data pointer is null."
    )


def test_asking_for_a_mode_claims_nothing():
    interface = JointModeInterface()
    interface.register_handle(JointModeHandle("j", [JointCommandMode.NOMODE]))

    interface.get_handle("j")

    assert interface.get_claims() == []
