"""The messages between libfranka and an arm, as one table for all versions.

A request and its answers begin with a header: command, number of the request, size of
the whole message. TCP carries them. UDP carries a `RobotState` to the client in every
cycle, and a `RobotCommand` back while a motion runs.

The lists below contain the parts of all versions; `_SPOKEN` has a column per version
for the parts that some versions lack. The number of a command or a status on the wire
is its rank among those that the version has. Inside the station each command has one
number for all versions, and each status one name.

Source: libfranka-common include/research_interface/robot/service_types.h, rbk_types.h:
@e6aa0fc version 5, @5adeec6 version 6, @dd768c8 version 7, @22b0837 version 8, @cd38d0e
version 9, @d96c221 version 10.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum, auto
from functools import partial
from typing import Generic, TypeAlias, TypeVar

from station.hw.franka.fci.wire.structure import Field, Structure, fields

CommandT = TypeVar("CommandT", bound=IntEnum)

HEADER = Structure(fields("I command command_id size"))
"""Head of every TCP message to and from an arm."""


class Command(IntEnum):
    """The commands of an arm, in the order of their numbers on the wire."""

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
    GET_ROBOT_MODEL = 14


class Status(Enum):
    """The statuses of all answers; see `Exchange` for their numbers on the wire."""

    SUCCESS = auto()
    INCOMPATIBLE_LIBRARY_VERSION = auto()
    MOTION_STARTED = auto()
    PREEMPTED = auto()
    PREEMPTED_BY_SAFETY = auto()
    REJECTED_BY_SAFETY = auto()
    COMMAND_NOT_POSSIBLE_REJECTED = auto()
    START_AT_SINGULAR_POSE_REJECTED = auto()
    INVALID_ARGUMENT_REJECTED = auto()
    MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED = auto()
    REFLEX_ABORTED = auto()
    EMERGENCY_ABORTED = auto()
    INPUT_ERROR_ABORTED = auto()
    ABORTED = auto()
    ERROR = auto()
    FAIL = auto()  # of a hand, as the next one
    UNSUCCESSFUL = auto()
    UNKNOWN = auto()  # stands for a number that the version does not have


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
"""`motion_generator_mode` of a state without a motion; with a motion it is the number
of the `MoveGenerator` plus 1."""
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


_POSITION_LIMITS = (
    "joint_motion_generator_position_limits_violation",
    "cartesian_motion_generator_joint_position_limits_violation",
)
MERGED_INTO = "joint_position_limits_violation"
"""The error that newer versions have in place of some others."""


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
    statuses: Sequence[Status]

    def status_of(self, number: int) -> Status:
        """Return the status with a number on the wire.

        Args:
            number: The number; one that the version does not have becomes
                `Status.UNKNOWN`.
        """
        known = self.statuses
        return known[number] if number < len(known) else Status.UNKNOWN


@dataclass(frozen=True, slots=True)
class FciProtocol(Generic[CommandT]):
    """One version of the protocol of an arm or of a hand.

    Attributes:
        device: `arm` or `hand`.
        version: Number that a client names when it connects.
        port: TCP port of the server.
        header: Head of every TCP message.
        connect: The command that comes first.
        exchanges: Request and answer of every command.
        state: Structure of the device's states.
        command: Structure of the client's answers to the states while a motion runs.
            A hand gets none, and has nothing of what follows.
        generators: The motion generators that a `MOVE` may ask for.
        merged_errors: Errors in whose place the version has `MERGED_INTO`.
        is_single: Whether the state has single precision.
    """

    device: str
    version: int
    port: int
    header: Structure
    connect: CommandT
    exchanges: Mapping[CommandT, Exchange]
    state: Structure
    command: Structure
    generators: Sequence[MoveGenerator] = ()
    merged_errors: Sequence[str] = ()
    is_single: bool = False


RobotProtocol: TypeAlias = FciProtocol[Command]
"""One version of the protocol of an arm."""

Row: TypeAlias = tuple[list[Field], list[Field], list[Status]]
"""Fields of a request, those of its answer behind the status, and the statuses."""


def row(*request: str, answer: Sequence[str] = (), statuses: str) -> Row:
    """Return the row of a command.

    Args:
        request: Fields of the request, as `fields` reads them.
        answer: Those of the answer behind the status.
        statuses: Names of the statuses of an answer, in the order of their numbers.
    """
    named = [Status[name] for name in statuses.split()]
    return fields(*request), fields(*answer), named


CONNECT_ROW = row(
    "H version udp_port",
    answer=["H version"],
    statuses="SUCCESS INCOMPATIBLE_LIBRARY_VERSION",
)
"""The row of the command with which clients of arms and hands begin."""
_setter = partial(
    row,
    statuses="SUCCESS COMMAND_NOT_POSSIBLE_REJECTED INVALID_ARGUMENT_REJECTED "
    "REJECTED_BY_SAFETY",
)
_THRESHOLDS = [
    f"{form} {bound}_{kind}_thresholds_{phase}"
    for form, kind in (("7d", "torque"), ("6d", "force"))
    for phase in ("acceleration", "nominal")
    for bound in ("lower", "upper")
]
_ROWS = {
    Command.CONNECT: CONNECT_ROW,
    Command.MOVE: row(
        "I controller_mode motion_generator_mode",
        "3d maximum_path_deviation maximum_goal_pose_deviation",
        "? use_async_motion_generator",
        "7d maximum_velocity",
        statuses="SUCCESS MOTION_STARTED PREEMPTED PREEMPTED_BY_SAFETY "
        "REJECTED_BY_SAFETY COMMAND_NOT_POSSIBLE_REJECTED "
        "START_AT_SINGULAR_POSE_REJECTED INVALID_ARGUMENT_REJECTED REFLEX_ABORTED "
        "EMERGENCY_ABORTED INPUT_ERROR_ABORTED ABORTED",
    ),
    Command.STOP_MOVE: row(
        statuses="SUCCESS COMMAND_NOT_POSSIBLE_REJECTED REJECTED_BY_SAFETY "
        "EMERGENCY_ABORTED REFLEX_ABORTED ABORTED"
    ),
    Command.GET_CARTESIAN_LIMIT: _setter(
        "i id",
        answer=["3d object_world_size", "16d object_frame", "? object_activation"],
    ),
    Command.SET_COLLISION_BEHAVIOR: _setter(*_THRESHOLDS),
    Command.SET_JOINT_IMPEDANCE: _setter("7d K_theta"),
    Command.SET_CARTESIAN_IMPEDANCE: _setter("6d K_x"),
    Command.SET_GUIDING_MODE: _setter("6? guiding_mode", "? nullspace"),
    Command.SET_EE_TO_K: _setter("16d EE_T_K"),
    Command.SET_NE_TO_EE: _setter("16d NE_T_EE"),
    Command.SET_LOAD: _setter("d m_load", "3d F_x_Cload", "9d I_load"),
    Command.SET_FILTERS: _setter(
        "d joint_position_filter_frequency joint_velocity_filter_frequency",
        "d cartesian_position_filter_frequency cartesian_velocity_filter_frequency",
        "d controller_filter_frequency",
    ),
    Command.AUTOMATIC_ERROR_RECOVERY: row(
        statuses="SUCCESS COMMAND_NOT_POSSIBLE_REJECTED REJECTED_BY_SAFETY "
        "MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED REFLEX_ABORTED EMERGENCY_ABORTED "
        "ABORTED"
    ),
    Command.LOAD_MODEL_LIBRARY: row("B architecture system", statuses="SUCCESS ERROR"),
    Command.GET_ROBOT_MODEL: row(
        statuses="SUCCESS COMMAND_NOT_POSSIBLE_REJECTED REJECTED_BY_SAFETY"
    ),
}

_STATE = fields(
    "Q message_id",
    "16d O_T_EE O_T_EE_d F_T_EE EE_T_K F_T_NE NE_T_EE",
    "d m_ee",
    "9d I_ee",
    "3d F_x_Cee",
    "d m_load",
    "9d I_load",
    "3d F_x_Cload",
    "2d elbow elbow_d",
    "7d tau_J tau_J_d dtau_J q q_d dq dq_d ddq_d",
    "7d joint_contact",
    "6d cartesian_contact",
    "7d joint_collision",
    "6d cartesian_collision",
    "7d tau_ext_hat_filtered",
    "6d O_F_ext_hat_K K_F_ext_hat_K O_dP_EE_d",
    "3d O_ddP_O",
    "2d elbow_c delbow_c ddelbow_c",
    "16d O_T_EE_c",
    "6d O_dP_EE_c O_ddP_EE_c",
    "7d theta dtheta",
    "18d accelerometer_top accelerometer_bottom",
    "B motion_generator_mode controller_mode",
    "41? errors reflex_reason",
    "B robot_mode",
    "d control_command_success_rate",
)

_COMMAND = fields(
    "Q message_id",
    "7d q_c dq_c",
    "16d O_T_EE_c",
    "6d O_dP_EE_c",
    "2d elbow_c",
    "? valid_elbow motion_generation_finished",
    "7d tau_J_d",
    "? torque_command_finished",
)

_VERSIONS = (5, 6, 7, 8, 9, 10)
_SPOKEN = {
    # Versions:                   5 6 7 8 9 10
    "GET_CARTESIAN_LIMIT":        "x.....",
    "SET_FILTERS":                "x.....",
    "LOAD_MODEL_LIBRARY":         "xxxxx.",
    "GET_ROBOT_MODEL":            "...xxx",
    "PREEMPTED_BY_SAFETY":        ".xxxxx",
    "REJECTED_BY_SAFETY":         ".xxxxx",
    "NONE":                       "..xxxx",
    "torque_command_finished":    "..xxxx",
    "use_async_motion_generator": ".....x",
    "maximum_velocity":           ".....x",
    "accelerometer_top":          ".....x",
    "accelerometer_bottom":       ".....x",
    "single precision":           ".....x",
    "position limits":            "xxxx..",
}  # fmt: skip
"""The parts that some versions lack: commands, statuses, the generator `NONE`, fields,
numbers of the state in single precision, and errors of their own for the position
limits of commanded motions."""


def _has(version: int, name: str) -> bool:
    return name not in _SPOKEN or _SPOKEN[name][_VERSIONS.index(version)] == "x"


def _structure(version: int, told: Sequence[Field]) -> Structure:
    return Structure([field for field in told if _has(version, field[0])])


def _exchange(version: int, command: Command, number: int) -> Exchange:
    request, answer, statuses = _ROWS[command]
    return Exchange(
        _structure(version, request),
        _structure(version, [("status", "B"), *answer]),
        number,
        tuple(status for status in statuses if _has(version, status.name)),
    )


def _protocol(version: int) -> RobotProtocol:
    commands = [command for command in Command if _has(version, command.name)]
    number = "f" if _has(version, "single precision") else "d"
    return FciProtocol(
        device="arm",
        version=version,
        port=1337,
        header=HEADER,
        connect=Command.CONNECT,
        exchanges={
            command: _exchange(version, command, number)
            for number, command in enumerate(commands)
        },
        state=_structure(
            version, [(name, form.replace("d", number)) for name, form in _STATE]
        ),
        command=_structure(version, _COMMAND),
        generators=tuple(one for one in MoveGenerator if _has(version, one.name)),
        merged_errors=() if _has(version, "position limits") else _POSITION_LIMITS,
        is_single=number == "f",
    )


PROTOCOLS = {version: _protocol(version) for version in _VERSIONS}
"""Every version with a table, by its number, oldest first."""
PANDA = PROTOCOLS[5]
"""The version of the Panda, which libfranka 0.9 speaks; 0.8 speaks version 4."""
FR3 = tuple(protocol for version, protocol in PROTOCOLS.items() if version > 5)
"""The versions of the FR3: 6 since libfranka 0.10, 7 since 0.13.3, 8 since 0.14, 9
since 0.15, 10 since 0.18."""


def versions_of_arm(arm: str) -> Sequence[RobotProtocol]:
    """Return the versions of a kind of arm, oldest first.

    Args:
        arm: `panda` or `fr3`.
    """
    return FR3 if arm == "fr3" else (PANDA,)


def protocols_of(arm: str, version: int | None = None) -> Sequence[RobotProtocol]:
    """Return the versions that clients of a simulated arm may use, the arm's own last.

    The arm's own version is the newest for its kind. A real arm accepts only one.

    Args:
        arm: `panda` or `fr3`.
        version: The only version; None for all versions with a table.
    """
    if version is not None:
        return (PROTOCOLS[version],)
    own = versions_of_arm(arm)[-1]
    return (*(one for one in PROTOCOLS.values() if one is not own), own)
