"""The tables of the protocol, against a C compiler's view of the public headers."""

import ctypes

import pytest
from hypothesis import given, strategies as st

from station.core.franka.franka_errors import ERROR_NAMES
from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.fci.wire.robot_protocol import (
    FR3,
    PANDA,
    PROTOCOLS,
    UNKNOWN,
    Command,
    ConnectStatus,
    ModelStatus,
    MoveGenerator,
    MoveStatus,
    RecoveryStatus,
    SetterStatus,
    StopMoveStatus,
)
from tests.hw.franka.fci.wire.drawn_values import values_of

D, B, BOOL = ctypes.c_double, ctypes.c_uint8, ctypes.c_bool


class PackedState(ctypes.LittleEndianStructure):
    """Head and tail of libfranka-common's RobotState under `#pragma pack(1)`.

    The doubles in between are counted from the header file: 6 poses, two bodies of 13,
    2 elbows, 8 + 7 arrays of joints or axes, and so on.
    """

    _pack_ = 1
    _layout_ = "ms"
    _fields_ = [
        ("message_id", ctypes.c_uint64),
        ("poses", D * (6 * 16)),
        ("bodies", D * 26),
        ("elbows", D * 4),
        ("joints", D * (8 * 7)),
        ("contacts", D * (2 * 13)),
        ("external", D * (7 + 6 + 6)),
        ("O_dP_EE_d", D * 6),
        ("O_ddP_O", D * 3),
        ("commanded", D * (6 + 16 + 12)),
        ("motors", D * 14),
        ("motion_generator_mode", B),
        ("controller_mode", B),
        ("errors", BOOL * 41),
        ("reflex_reason", BOOL * 41),
        ("robot_mode", B),
        ("control_command_success_rate", D),
    ]


class PackedCommand(ctypes.LittleEndianStructure):
    """libfranka-common's RobotCommand, its two parts in a row."""

    _pack_ = 1
    _layout_ = "ms"
    _fields_ = [
        ("message_id", ctypes.c_uint64),
        ("q_c", D * 7),
        ("dq_c", D * 7),
        ("O_T_EE_c", D * 16),
        ("O_dP_EE_c", D * 6),
        ("elbow_c", D * 2),
        ("valid_elbow", BOOL),
        ("motion_generation_finished", BOOL),
        ("tau_J_d", D * 7),
    ]


def test_state_has_the_size_and_the_offsets_of_the_header_file():
    assert PANDA.state.size == ctypes.sizeof(PackedState) == 2373
    tail = ("motion_generator_mode", "errors", "reflex_reason", "robot_mode")
    for name in ("O_dP_EE_d", "O_ddP_O", *tail, "control_command_success_rate"):
        assert PANDA.state.offsets[name] == getattr(PackedState, name).offset


def test_command_has_the_size_and_the_offsets_of_the_header_file():
    assert PANDA.command.size == ctypes.sizeof(PackedCommand) == 370
    for name, offset in PANDA.command.offsets.items():
        assert offset == getattr(PackedCommand, name).offset


# Sizes of libfranka-common's packed classes, counted by hand, header not included.
SIZES = {
    Command.CONNECT: (4, 3),
    Command.MOVE: (56, 1),
    Command.STOP_MOVE: (0, 1),
    Command.GET_CARTESIAN_LIMIT: (4, 154),
    Command.SET_COLLISION_BEHAVIOR: (416, 1),
    Command.SET_JOINT_IMPEDANCE: (56, 1),
    Command.SET_CARTESIAN_IMPEDANCE: (48, 1),
    Command.SET_GUIDING_MODE: (7, 1),
    Command.SET_EE_TO_K: (128, 1),
    Command.SET_NE_TO_EE: (128, 1),
    Command.SET_LOAD: (104, 1),
    Command.SET_FILTERS: (40, 1),
    Command.AUTOMATIC_ERROR_RECOVERY: (0, 1),
    Command.LOAD_MODEL_LIBRARY: (2, 1),
}


@pytest.mark.parametrize("command", Command)
def test_requests_and_answers_have_their_sizes(command):
    exchange = PANDA.exchanges[command]
    assert (exchange.request.size, exchange.response.size) == SIZES[command]


def test_numbers_are_those_of_the_header_file():
    assert [c.value for c in Command] == list(range(14))
    assert ConnectStatus.INCOMPATIBLE_LIBRARY_VERSION == 1
    assert (MoveStatus.PREEMPTED, MoveStatus.REFLEX_ABORTED, MoveStatus.ABORTED) == (
        2,
        6,
        9,
    )
    assert [p.version for p in PROTOCOLS.values()] == [*PROTOCOLS] == [5, 6, 7]
    assert PANDA.port == 1337
    assert PANDA.state.counts["errors"] == len(ERROR_NAMES)


# What g++ 12 says of the headers of versions 6 (@5adeec6) and 7 (@dd768c8): sizeof,
# offsetof and the numbers of the enumerators.
NUMBERS_OF_FR3 = {
    Command.CONNECT: 0,
    Command.MOVE: 1,
    Command.STOP_MOVE: 2,
    Command.SET_COLLISION_BEHAVIOR: 3,
    Command.SET_JOINT_IMPEDANCE: 4,
    Command.SET_CARTESIAN_IMPEDANCE: 5,
    Command.SET_GUIDING_MODE: 6,
    Command.SET_EE_TO_K: 7,
    Command.SET_NE_TO_EE: 8,
    Command.SET_LOAD: 9,
    Command.AUTOMATIC_ERROR_RECOVERY: 10,
    Command.LOAD_MODEL_LIBRARY: 11,
}
STATUSES_OF_FR3 = {
    (Command.MOVE, MoveStatus.MOTION_STARTED): 1,
    (Command.MOVE, MoveStatus.PREEMPTED): 2,
    (Command.MOVE, MoveStatus.PREEMPTED_BY_SAFETY): 3,
    (Command.MOVE, MoveStatus.REJECTED_BY_SAFETY): 4,
    (Command.MOVE, MoveStatus.COMMAND_NOT_POSSIBLE_REJECTED): 5,
    (Command.MOVE, MoveStatus.START_AT_SINGULAR_POSE_REJECTED): 6,
    (Command.MOVE, MoveStatus.INVALID_ARGUMENT_REJECTED): 7,
    (Command.MOVE, MoveStatus.REFLEX_ABORTED): 8,
    (Command.MOVE, MoveStatus.EMERGENCY_ABORTED): 9,
    (Command.MOVE, MoveStatus.INPUT_ERROR_ABORTED): 10,
    (Command.MOVE, MoveStatus.ABORTED): 11,
    (Command.STOP_MOVE, StopMoveStatus.COMMAND_NOT_POSSIBLE_REJECTED): 1,
    (Command.STOP_MOVE, StopMoveStatus.REJECTED_BY_SAFETY): 2,
    (Command.STOP_MOVE, StopMoveStatus.EMERGENCY_ABORTED): 3,
    (Command.STOP_MOVE, StopMoveStatus.REFLEX_ABORTED): 4,
    (Command.STOP_MOVE, StopMoveStatus.ABORTED): 5,
    (Command.AUTOMATIC_ERROR_RECOVERY, RecoveryStatus.REJECTED_BY_SAFETY): 2,
    (
        Command.AUTOMATIC_ERROR_RECOVERY,
        RecoveryStatus.MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED,
    ): 3,
    (Command.AUTOMATIC_ERROR_RECOVERY, RecoveryStatus.REFLEX_ABORTED): 4,
    (Command.AUTOMATIC_ERROR_RECOVERY, RecoveryStatus.EMERGENCY_ABORTED): 5,
    (Command.AUTOMATIC_ERROR_RECOVERY, RecoveryStatus.ABORTED): 6,
    (Command.SET_LOAD, SetterStatus.COMMAND_NOT_POSSIBLE_REJECTED): 1,
    (Command.SET_LOAD, SetterStatus.INVALID_ARGUMENT_REJECTED): 2,
    (Command.SET_LOAD, SetterStatus.REJECTED_BY_SAFETY): 3,
    (Command.LOAD_MODEL_LIBRARY, ModelStatus.ERROR): 1,
    (Command.CONNECT, ConnectStatus.INCOMPATIBLE_LIBRARY_VERSION): 1,
}


@pytest.mark.parametrize("protocol", FR3, ids=lambda p: f"version {p.version}")
def test_versions_of_the_fr3_have_the_numbers_and_sizes_of_their_headers(protocol):
    assert {c: one.number for c, one in protocol.exchanges.items()} == NUMBERS_OF_FR3
    for command, exchange in protocol.exchanges.items():
        sizes = exchange.request.size, exchange.response.size
        assert sizes == SIZES[command]
    for (command, status), number in STATUSES_OF_FR3.items():
        exchange = protocol.exchanges[command]
        assert exchange.statuses.index(status) == number
        assert exchange.status_of(number) == status
    assert protocol.state.size == 2373
    assert protocol.state.offsets == PANDA.state.offsets
    assert protocol.command.size == {6: 370, 7: 371}[protocol.version]
    assert protocol.command.offsets["tau_J_d"] == 314


def test_version_7_ends_torques_and_has_motions_without_a_generator():
    version = PROTOCOLS[7]
    assert version.command.offsets["torque_command_finished"] == 314 + 56
    assert MoveGenerator.NONE == 4
    assert MoveGenerator.NONE in version.generators
    assert MoveGenerator.NONE not in PROTOCOLS[6].generators
    assert MoveGenerator.NONE not in PANDA.generators


def test_version_5_has_no_statuses_of_safety_functions():
    for exchange in PANDA.exchanges.values():
        assert list(exchange.statuses) == list(range(len(exchange.statuses)))
        assert exchange.status_of(77) == UNKNOWN


def test_every_array_of_the_message_is_one_of_the_arms_state_of_the_same_size():
    state = RobotState()
    arrays = [
        name for name, count in PANDA.state.counts.items() if count in range(2, 17)
    ]
    assert len(arrays) == 37
    for name in arrays:
        assert len(state.doubles(name)) == PANDA.state.counts[name]


@given(values_of(PANDA.command))
def test_a_command_comes_back_as_it_went(values):
    assert PANDA.command.unpack(PANDA.command.pack(values)) == values


@given(
    st.sampled_from(Command).flatmap(
        lambda c: st.tuples(st.just(c), values_of(PANDA.exchanges[c].request))
    )
)
def test_a_request_comes_back_as_it_went(drawn):
    command, values = drawn
    request = PANDA.exchanges[command].request
    assert request.unpack(request.pack(values)) == values
