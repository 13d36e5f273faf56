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
    Command,
    MoveGenerator,
    Status,
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


# What g++ 12 says of the headers of all versions: sizeof, offsetof and the numbers of
# the enumerators. Sizes of request and answer, header not included.
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
    Command.GET_ROBOT_MODEL: (0, 1),
}
MOVE_OF_VERSION_10 = (113, 1)
NUMBERS = {
    # Versions:                     5  6   7   8   9  10
    Command.CONNECT:               (0, 0, 0, 0, 0, 0),
    Command.MOVE:                  (1, 1, 1, 1, 1, 1),
    Command.STOP_MOVE:             (2, 2, 2, 2, 2, 2),
    Command.GET_CARTESIAN_LIMIT:   (3, None, None, None, None, None),
    Command.SET_COLLISION_BEHAVIOR: (4, 3, 3, 3, 3, 3),
    Command.SET_JOINT_IMPEDANCE:   (5, 4, 4, 4, 4, 4),
    Command.SET_CARTESIAN_IMPEDANCE: (6, 5, 5, 5, 5, 5),
    Command.SET_GUIDING_MODE:      (7, 6, 6, 6, 6, 6),
    Command.SET_EE_TO_K:           (8, 7, 7, 7, 7, 7),
    Command.SET_NE_TO_EE:          (9, 8, 8, 8, 8, 8),
    Command.SET_LOAD:              (10, 9, 9, 9, 9, 9),
    Command.SET_FILTERS:           (11, None, None, None, None, None),
    Command.AUTOMATIC_ERROR_RECOVERY: (12, 10, 10, 10, 10, 10),
    Command.LOAD_MODEL_LIBRARY:    (13, 11, 11, 11, 11, None),
    Command.GET_ROBOT_MODEL:       (None, None, None, 12, 12, 11),
}  # fmt: skip


@pytest.mark.parametrize("protocol", PROTOCOLS.values(), ids=lambda p: p.version)
def test_requests_and_answers_have_the_numbers_and_sizes_of_the_headers(protocol):
    column = protocol.version - 5
    numbers = {c: row[column] for c, row in NUMBERS.items() if row[column] is not None}
    assert {c: one.number for c, one in protocol.exchanges.items()} == numbers
    expected = SIZES | ({Command.MOVE: MOVE_OF_VERSION_10} if column == 5 else {})
    for command, exchange in protocol.exchanges.items():
        sizes = exchange.request.size, exchange.response.size
        assert sizes == expected[command]


def test_numbers_are_those_of_the_header_file():
    assert [p.version for p in PROTOCOLS.values()] == [*PROTOCOLS]
    assert [*PROTOCOLS] == [5, 6, 7, 8, 9, 10]
    assert PANDA.port == 1337
    for protocol in PROTOCOLS.values():
        assert protocol.state.counts["errors"] == len(ERROR_NAMES) == 41


STATUSES_OF_FR3 = {
    (Command.MOVE, Status.MOTION_STARTED): 1,
    (Command.MOVE, Status.PREEMPTED): 2,
    (Command.MOVE, Status.PREEMPTED_BY_SAFETY): 3,
    (Command.MOVE, Status.REJECTED_BY_SAFETY): 4,
    (Command.MOVE, Status.COMMAND_NOT_POSSIBLE_REJECTED): 5,
    (Command.MOVE, Status.START_AT_SINGULAR_POSE_REJECTED): 6,
    (Command.MOVE, Status.INVALID_ARGUMENT_REJECTED): 7,
    (Command.MOVE, Status.REFLEX_ABORTED): 8,
    (Command.MOVE, Status.EMERGENCY_ABORTED): 9,
    (Command.MOVE, Status.INPUT_ERROR_ABORTED): 10,
    (Command.MOVE, Status.ABORTED): 11,
    (Command.STOP_MOVE, Status.COMMAND_NOT_POSSIBLE_REJECTED): 1,
    (Command.STOP_MOVE, Status.REJECTED_BY_SAFETY): 2,
    (Command.STOP_MOVE, Status.EMERGENCY_ABORTED): 3,
    (Command.STOP_MOVE, Status.REFLEX_ABORTED): 4,
    (Command.STOP_MOVE, Status.ABORTED): 5,
    (Command.AUTOMATIC_ERROR_RECOVERY, Status.REJECTED_BY_SAFETY): 2,
    (
        Command.AUTOMATIC_ERROR_RECOVERY,
        Status.MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED,
    ): 3,
    (Command.AUTOMATIC_ERROR_RECOVERY, Status.REFLEX_ABORTED): 4,
    (Command.AUTOMATIC_ERROR_RECOVERY, Status.EMERGENCY_ABORTED): 5,
    (Command.AUTOMATIC_ERROR_RECOVERY, Status.ABORTED): 6,
    (Command.SET_LOAD, Status.COMMAND_NOT_POSSIBLE_REJECTED): 1,
    (Command.SET_LOAD, Status.INVALID_ARGUMENT_REJECTED): 2,
    (Command.SET_LOAD, Status.REJECTED_BY_SAFETY): 3,
    (Command.LOAD_MODEL_LIBRARY, Status.ERROR): 1,
    (Command.GET_ROBOT_MODEL, Status.COMMAND_NOT_POSSIBLE_REJECTED): 1,
    (Command.GET_ROBOT_MODEL, Status.REJECTED_BY_SAFETY): 2,
    (Command.CONNECT, Status.INCOMPATIBLE_LIBRARY_VERSION): 1,
}


@pytest.mark.parametrize("protocol", FR3, ids=lambda p: f"version {p.version}")
def test_versions_of_the_fr3_have_the_statuses_of_their_headers(protocol):
    for (command, status), number in STATUSES_OF_FR3.items():
        exchange = protocol.exchanges.get(command)
        if exchange is not None:
            assert exchange.statuses.index(status) == number
            assert exchange.status_of(number) == status


@pytest.mark.parametrize("version", [5, 6, 7, 8, 9])
def test_states_up_to_version_9_are_those_of_the_panda(version):
    protocol = PROTOCOLS[version]
    assert protocol.state.size == 2373
    assert protocol.state.offsets == PANDA.state.offsets
    assert protocol.command.size == (370 if version < 7 else 371)
    assert protocol.command.offsets["tau_J_d"] == 314


# Offsets in the states of version 10 and of the older ones.
OFFSETS = {
    "message_id": (0, 0), "O_T_EE": (8, 8), "O_T_EE_d": (72, 136),
    "F_T_EE": (136, 264), "EE_T_K": (200, 392), "F_T_NE": (264, 520),
    "NE_T_EE": (328, 648), "m_ee": (392, 776), "I_ee": (396, 784),
    "F_x_Cee": (432, 856), "m_load": (444, 880), "I_load": (448, 888),
    "F_x_Cload": (484, 960), "elbow": (496, 984), "elbow_d": (504, 1000),
    "tau_J": (512, 1016), "tau_J_d": (540, 1072), "dtau_J": (568, 1128),
    "q": (596, 1184), "q_d": (624, 1240), "dq": (652, 1296), "dq_d": (680, 1352),
    "ddq_d": (708, 1408), "joint_contact": (736, 1464),
    "cartesian_contact": (764, 1520), "joint_collision": (788, 1568),
    "cartesian_collision": (816, 1624), "tau_ext_hat_filtered": (840, 1672),
    "O_F_ext_hat_K": (868, 1728), "K_F_ext_hat_K": (892, 1776),
    "O_dP_EE_d": (916, 1824), "O_ddP_O": (940, 1872), "elbow_c": (952, 1896),
    "delbow_c": (960, 1912), "ddelbow_c": (968, 1928), "O_T_EE_c": (976, 1944),
    "O_dP_EE_c": (1040, 2072), "O_ddP_EE_c": (1064, 2120), "theta": (1088, 2168),
    "dtheta": (1116, 2224), "accelerometer_top": (1144, None),
    "accelerometer_bottom": (1216, None), "motion_generator_mode": (1288, 2280),
    "controller_mode": (1289, 2281), "errors": (1290, 2282),
    "reflex_reason": (1331, 2323), "robot_mode": (1372, 2364),
    "control_command_success_rate": (1373, 2365),
}  # fmt: skip


def test_state_of_version_10_is_in_single_precision_and_has_accelerometers():
    newest = PROTOCOLS[10].state
    assert newest.size == 1377
    assert newest.offsets == {name: both[0] for name, both in OFFSETS.items()}
    older = {name: old for name, (_, old) in OFFSETS.items() if old is not None}
    assert PANDA.state.offsets == older


def test_move_of_version_10_may_be_asynchronous():
    move = PROTOCOLS[10].exchanges[Command.MOVE].request
    assert move.offsets == {
        "controller_mode": 0,
        "motion_generator_mode": 4,
        "maximum_path_deviation": 8,
        "maximum_goal_pose_deviation": 32,
        "use_async_motion_generator": 56,
        "maximum_velocity": 57,
    }
    assert PROTOCOLS[10].command.offsets["torque_command_finished"] == 370


def test_version_7_ends_torques_and_has_motions_without_a_generator():
    version = PROTOCOLS[7]
    assert version.command.offsets["torque_command_finished"] == 314 + 56
    assert MoveGenerator.NONE == 4
    assert MoveGenerator.NONE in version.generators
    assert MoveGenerator.NONE not in PROTOCOLS[6].generators
    assert MoveGenerator.NONE not in PANDA.generators


STATUSES_OF_PANDA = {
    Command.CONNECT: "success, incompatible library version",
    Command.MOVE: "success, motion started, preempted, command not possible rejected, "
    "start at singular pose rejected, invalid argument rejected, reflex aborted, "
    "emergency aborted, input error aborted, aborted",
    Command.STOP_MOVE: "success, command not possible rejected, emergency aborted, "
    "reflex aborted, aborted",
    Command.AUTOMATIC_ERROR_RECOVERY: "success, command not possible rejected, manual "
    "error recovery required rejected, reflex aborted, emergency aborted, aborted",
    Command.LOAD_MODEL_LIBRARY: "success, error",
}
SETTER = "success, command not possible rejected, invalid argument rejected"


def test_version_5_has_the_statuses_of_its_header_none_of_safety_functions():
    for command, exchange in PANDA.exchanges.items():
        named = [status.name.lower().replace("_", " ") for status in exchange.statuses]
        assert ", ".join(named) == STATUSES_OF_PANDA.get(command, SETTER)
        assert exchange.status_of(77) is Status.UNKNOWN


def test_every_array_of_the_message_is_one_of_the_arms_state_of_the_same_size():
    state = RobotState()
    arrays = [
        name for name, count in PANDA.state.counts.items() if count in range(2, 17)
    ]  # the flags of errors are 41
    assert len(arrays) == 37
    for name in arrays:
        assert len(state.doubles(name)) == PANDA.state.counts[name]


STRUCTURES = [
    structure
    for protocol in PROTOCOLS.values()
    for structure in (
        protocol.command,
        *(one.request for one in protocol.exchanges.values()),
    )
]


@given(
    st.sampled_from(STRUCTURES).flatmap(lambda s: st.tuples(st.just(s), values_of(s)))
)
def test_a_command_or_a_request_comes_back_as_it_went(drawn):
    structure, values = drawn
    assert structure.unpack(structure.pack(values)) == values
