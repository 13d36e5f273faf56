"""The messages between libfranka and an arm, as tables; one table per version.

A request and its answers begin with a header: command, number of the request, size of
the whole message. TCP carries them. UDP carries a `RobotState` to the client in every
cycle, and a `RobotCommand` back while a motion runs.

Commands and statuses have one number each here, that of version 5; the tables say by
which number a version knows them. A version that only takes commands away, or adds
fields and statuses, is a table at the end of this module.

Source: libfranka-common include/research_interface/robot/service_types.h, rbk_types.h:
@e6aa0fc version 5, @5adeec6 version 6, @dd768c8 version 7.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

from station.hw.franka.fci.wire.structure import Field, Structure

HEADER = Structure([("command", "I"), ("command_id", "I"), ("size", "I")])
"""Head of every TCP message to and from an arm."""


class Command(IntEnum):
    """The commands of an arm, with their numbers in version 5."""

    CONNECT = 0
    MOVE = 1
    STOP_MOVE = 2
    GET_CARTESIAN_LIMIT = 3
    SET_COLLISION_BEHAVIOR = 4
    SET_JOINT_IMPEDANCE = 5
    SET_CARTESIAN_IMPEDANCE = 6
    SET_GUIDING_MODE = 7
    SET_EE_TO_K = 8
    SET_NE_TO_EE = 9
    SET_LOAD = 10
    SET_FILTERS = 11
    AUTOMATIC_ERROR_RECOVERY = 12
    LOAD_MODEL_LIBRARY = 13


class ConnectStatus(IntEnum):
    """Answers to `CONNECT`."""

    SUCCESS = 0
    INCOMPATIBLE_LIBRARY_VERSION = 1


class MoveStatus(IntEnum):
    """Answers to `MOVE`: `MOTION_STARTED` at the beginning, another one at the end."""

    SUCCESS = 0
    MOTION_STARTED = 1
    PREEMPTED = 2
    COMMAND_NOT_POSSIBLE_REJECTED = 3
    START_AT_SINGULAR_POSE_REJECTED = 4
    INVALID_ARGUMENT_REJECTED = 5
    REFLEX_ABORTED = 6
    EMERGENCY_ABORTED = 7
    INPUT_ERROR_ABORTED = 8
    ABORTED = 9
    PREEMPTED_BY_SAFETY = 100
    REJECTED_BY_SAFETY = 101


class StopMoveStatus(IntEnum):
    """Answers to `STOP_MOVE`."""

    SUCCESS = 0
    COMMAND_NOT_POSSIBLE_REJECTED = 1
    EMERGENCY_ABORTED = 2
    REFLEX_ABORTED = 3
    ABORTED = 4
    REJECTED_BY_SAFETY = 101


class SetterStatus(IntEnum):
    """Answers to the setters and to `GET_CARTESIAN_LIMIT`."""

    SUCCESS = 0
    COMMAND_NOT_POSSIBLE_REJECTED = 1
    INVALID_ARGUMENT_REJECTED = 2
    REJECTED_BY_SAFETY = 101


class RecoveryStatus(IntEnum):
    """Answers to `AUTOMATIC_ERROR_RECOVERY`."""

    SUCCESS = 0
    COMMAND_NOT_POSSIBLE_REJECTED = 1
    MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED = 2
    REFLEX_ABORTED = 3
    EMERGENCY_ABORTED = 4
    ABORTED = 5
    REJECTED_BY_SAFETY = 101


class ModelStatus(IntEnum):
    """Answers to `LOAD_MODEL_LIBRARY`."""

    SUCCESS = 0
    ERROR = 1


class MoveController(IntEnum):
    """The controller that a `MOVE` asks for."""

    JOINT_IMPEDANCE = 0
    CARTESIAN_IMPEDANCE = 1
    EXTERNAL_CONTROLLER = 2


class MoveGenerator(IntEnum):
    """The motion generator of a `MOVE`; the state counts from 1, see below."""

    JOINT_POSITION = 0
    JOINT_VELOCITY = 1
    CARTESIAN_POSITION = 2
    CARTESIAN_VELOCITY = 3
    NONE = 4


NO_GENERATOR = 0
"""`motion_generator_mode` of a state without a motion; with one it is the number of
`MoveGenerator` and 1 more."""
NO_CONTROLLER = 3
"""`controller_mode` of a state without a motion."""


class Architecture(IntEnum):
    """The processors for which a client asks for a model library."""

    X64 = 0
    X86 = 1
    ARM = 2
    ARM64 = 3


class System(IntEnum):
    """The operating systems for which a client asks for a model library."""

    LINUX = 0
    WINDOWS = 1


UNKNOWN = 255
"""What a status is that the version does not have."""


@dataclass(frozen=True, slots=True)
class Exchange:
    """The formats that follow the header in a request and in its answers.

    Attributes:
        request: The request.
        response: An answer; it begins with its status.
        number: Number of the command on the wire.
        statuses: The statuses of an answer, in the order of their numbers on the wire.
    """

    request: Structure
    response: Structure
    number: int
    statuses: Sequence[int]

    def status_of(self, number: int) -> int:
        """Return the status with a number on the wire.

        Args:
            number: The number; one that the version does not have becomes `UNKNOWN`.
        """
        known = self.statuses
        return known[number] if number < len(known) else UNKNOWN


@dataclass(frozen=True, slots=True)
class RobotProtocol:
    """One version of the protocol of an arm.

    Attributes:
        version: Number that a client names when it connects.
        port: TCP port of the server.
        exchanges: Request and answer of every command.
        state: What the arm sends in every cycle.
        command: What the client answers while a motion runs.
        generators: The motion generators that a `MOVE` may ask for.
    """

    version: int
    port: int
    exchanges: Mapping[Command, Exchange]
    state: Structure
    command: Structure
    generators: Sequence[MoveGenerator]


_STATUS: list[Field] = [("status", "B")]
_THRESHOLDS: list[Field] = [
    (f"{bound}_{kind}_thresholds_{phase}", "7d" if kind == "torque" else "6d")
    for kind in ("torque", "force")
    for phase in ("acceleration", "nominal")
    for bound in ("lower", "upper")
]
# Fields of the request, and those of the answer behind its status.
_EXCHANGES: dict[Command, tuple[list[Field], list[Field]]] = {
    Command.CONNECT: ([("version", "H"), ("udp_port", "H")], [("version", "H")]),
    Command.MOVE: (
        [
            ("controller_mode", "I"),
            ("motion_generator_mode", "I"),
            ("maximum_path_deviation", "3d"),
            ("maximum_goal_pose_deviation", "3d"),
        ],
        [],
    ),
    Command.STOP_MOVE: ([], []),
    Command.GET_CARTESIAN_LIMIT: (
        [("id", "i")],
        [
            ("object_world_size", "3d"),
            ("object_frame", "16d"),
            ("object_activation", "?"),
        ],
    ),
    Command.SET_COLLISION_BEHAVIOR: (_THRESHOLDS, []),
    Command.SET_JOINT_IMPEDANCE: ([("K_theta", "7d")], []),
    Command.SET_CARTESIAN_IMPEDANCE: ([("K_x", "6d")], []),
    Command.SET_GUIDING_MODE: ([("guiding_mode", "6?"), ("nullspace", "?")], []),
    Command.SET_EE_TO_K: ([("EE_T_K", "16d")], []),
    Command.SET_NE_TO_EE: ([("NE_T_EE", "16d")], []),
    Command.SET_LOAD: ([("m_load", "d"), ("F_x_Cload", "3d"), ("I_load", "9d")], []),
    Command.SET_FILTERS: (
        [
            ("joint_position_filter_frequency", "d"),
            ("joint_velocity_filter_frequency", "d"),
            ("cartesian_position_filter_frequency", "d"),
            ("cartesian_velocity_filter_frequency", "d"),
            ("controller_filter_frequency", "d"),
        ],
        [],
    ),
    Command.AUTOMATIC_ERROR_RECOVERY: ([], []),
    Command.LOAD_MODEL_LIBRARY: ([("architecture", "B"), ("system", "B")], []),
}

_STATE: list[Field] = [
    ("message_id", "Q"),
    ("O_T_EE", "16d"),
    ("O_T_EE_d", "16d"),
    ("F_T_EE", "16d"),
    ("EE_T_K", "16d"),
    ("F_T_NE", "16d"),
    ("NE_T_EE", "16d"),
    ("m_ee", "d"),
    ("I_ee", "9d"),
    ("F_x_Cee", "3d"),
    ("m_load", "d"),
    ("I_load", "9d"),
    ("F_x_Cload", "3d"),
    ("elbow", "2d"),
    ("elbow_d", "2d"),
    ("tau_J", "7d"),
    ("tau_J_d", "7d"),
    ("dtau_J", "7d"),
    ("q", "7d"),
    ("q_d", "7d"),
    ("dq", "7d"),
    ("dq_d", "7d"),
    ("ddq_d", "7d"),
    ("joint_contact", "7d"),
    ("cartesian_contact", "6d"),
    ("joint_collision", "7d"),
    ("cartesian_collision", "6d"),
    ("tau_ext_hat_filtered", "7d"),
    ("O_F_ext_hat_K", "6d"),
    ("K_F_ext_hat_K", "6d"),
    ("O_dP_EE_d", "6d"),
    ("O_ddP_O", "3d"),
    ("elbow_c", "2d"),
    ("delbow_c", "2d"),
    ("ddelbow_c", "2d"),
    ("O_T_EE_c", "16d"),
    ("O_dP_EE_c", "6d"),
    ("O_ddP_EE_c", "6d"),
    ("theta", "7d"),
    ("dtheta", "7d"),
    ("motion_generator_mode", "B"),
    ("controller_mode", "B"),
    ("errors", "41?"),
    ("reflex_reason", "41?"),
    ("robot_mode", "B"),
    ("control_command_success_rate", "d"),
]

_COMMAND: list[Field] = [
    ("message_id", "Q"),
    ("q_c", "7d"),
    ("dq_c", "7d"),
    ("O_T_EE_c", "16d"),
    ("O_dP_EE_c", "6d"),
    ("elbow_c", "2d"),
    ("valid_elbow", "?"),
    ("motion_generation_finished", "?"),
    ("tau_J_d", "7d"),
]

# Statuses from here on are those of safety functions, which version 5 does not have.
_FIRST_OF_SAFETY = 100
_STATUSES: dict[Command, Sequence[int]] = {
    Command.CONNECT: tuple(ConnectStatus),
    Command.MOVE: tuple(MoveStatus),
    Command.STOP_MOVE: tuple(StopMoveStatus),
    Command.AUTOMATIC_ERROR_RECOVERY: tuple(RecoveryStatus),
    Command.LOAD_MODEL_LIBRARY: tuple(ModelStatus),
}


def _without_safety(statuses: Sequence[int]) -> Sequence[int]:
    """Return the statuses that version 5 has, in the order of their numbers."""
    return tuple(status for status in statuses if status < _FIRST_OF_SAFETY)


_GENERATORS = tuple(g for g in MoveGenerator if g is not MoveGenerator.NONE)

PANDA = RobotProtocol(
    version=5,
    port=1337,
    exchanges={
        command: Exchange(
            Structure(request),
            Structure([*_STATUS, *answer]),
            command,
            _without_safety(_STATUSES.get(command, tuple(SetterStatus))),
        )
        for command, (request, answer) in _EXCHANGES.items()
    },
    state=Structure(_STATE),
    command=Structure(_COMMAND),
    generators=_GENERATORS,
)
"""Version 5, which the Panda's libfranka 0.9 speaks; 0.8 speaks version 4."""

_REMOVED = (Command.GET_CARTESIAN_LIMIT, Command.SET_FILTERS)
_STATUSES_WITH_SAFETY: dict[Command, Sequence[int]] = {
    Command.CONNECT: PANDA.exchanges[Command.CONNECT].statuses,
    Command.MOVE: (
        MoveStatus.SUCCESS,
        MoveStatus.MOTION_STARTED,
        MoveStatus.PREEMPTED,
        MoveStatus.PREEMPTED_BY_SAFETY,
        MoveStatus.REJECTED_BY_SAFETY,
        MoveStatus.COMMAND_NOT_POSSIBLE_REJECTED,
        MoveStatus.START_AT_SINGULAR_POSE_REJECTED,
        MoveStatus.INVALID_ARGUMENT_REJECTED,
        MoveStatus.REFLEX_ABORTED,
        MoveStatus.EMERGENCY_ABORTED,
        MoveStatus.INPUT_ERROR_ABORTED,
        MoveStatus.ABORTED,
    ),
    Command.STOP_MOVE: (
        StopMoveStatus.SUCCESS,
        StopMoveStatus.COMMAND_NOT_POSSIBLE_REJECTED,
        StopMoveStatus.REJECTED_BY_SAFETY,
        StopMoveStatus.EMERGENCY_ABORTED,
        StopMoveStatus.REFLEX_ABORTED,
        StopMoveStatus.ABORTED,
    ),
    Command.AUTOMATIC_ERROR_RECOVERY: (
        RecoveryStatus.SUCCESS,
        RecoveryStatus.COMMAND_NOT_POSSIBLE_REJECTED,
        RecoveryStatus.REJECTED_BY_SAFETY,
        RecoveryStatus.MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED,
        RecoveryStatus.REFLEX_ABORTED,
        RecoveryStatus.EMERGENCY_ABORTED,
        RecoveryStatus.ABORTED,
    ),
    Command.LOAD_MODEL_LIBRARY: PANDA.exchanges[Command.LOAD_MODEL_LIBRARY].statuses,
}
_SETTER_WITH_SAFETY = tuple(SetterStatus)

FR3_OF_LIBFRANKA_0_10 = replace(
    PANDA,
    version=6,
    exchanges={
        command: replace(
            PANDA.exchanges[command],
            number=number,
            statuses=_STATUSES_WITH_SAFETY.get(command, _SETTER_WITH_SAFETY),
        )
        for number, command in enumerate(c for c in Command if c not in _REMOVED)
    },
)
"""Version 6, which the FR3's libfranka 0.10 to 0.13.2 speak: no virtual walls and no
filters, so that the commands behind them have other numbers, and statuses of safety
functions."""
FR3_OF_LIBFRANKA_0_13 = replace(
    FR3_OF_LIBFRANKA_0_10,
    version=7,
    command=Structure([*_COMMAND, ("torque_command_finished", "?")]),
    generators=tuple(MoveGenerator),
)
"""Version 7, which the FR3's libfranka 0.13.3 to 0.13.6 speak: a motion may have no
generator, and torques have an end of their own."""
FR3 = (FR3_OF_LIBFRANKA_0_10, FR3_OF_LIBFRANKA_0_13)
"""The versions of the FR3 that have a table, oldest first."""
PROTOCOLS = {protocol.version: protocol for protocol in (PANDA, *FR3)}
"""Every version with a table, by its number."""
