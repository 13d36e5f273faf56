"""One client of an arm: its requests, its motion, and the answers; no sockets.

    CONNECT, once and first          -> SUCCESS, or INCOMPATIBLE_LIBRARY_VERSION
    MOVE                             -> MOTION_STARTED at rest, the outcome at its end
    MOVE, asynchronous               -> the same; the arm plans, see below
    the client finishes the motion   -> SUCCESS
    STOP_MOVE                        -> PREEMPTED to the motion, SUCCESS to the stop
    an error of the arm              -> REFLEX_ABORTED
    the user stop                    -> EMERGENCY_ABORTED
    an invalid command               -> INPUT_ERROR_ABORTED
    AUTOMATIC_ERROR_RECOVERY         -> when the recovery is over

A state shows the end of a motion before the answer goes out: clients report the errors
of the last state that they have read.

An asynchronous motion has one command per target instead of one per cycle, and cycles
without a command are not losses: the arm plans its way to the newest target.

Source: libfranka@0.9.2 src/robot_impl.cpp, src/robot_impl.h, for what the client
expects; differs: a motion that is finished while the arm still moves is slowed down to
rest. The settings are those of libfranka@0.9.2 include/franka/robot.h, the setters of
Robot; differs: a simulated arm gives way in all directions when it is guided, and has
no filters of its own, so that only these settings are accepted.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any

from typing_extensions import override

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.franka_errors import ERROR_INDEX
from station.core.franka.franka_robot_state import RobotMode
from station.core.franka.franka_services import CollisionBehavior
from station.hw.franka.arm.collision_behavior import check_collision_behavior
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import (
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
    SingularStartError,
)
from station.hw.franka.arm.service_limits import (
    JOINT_STIFFNESS,
    ROTATIONAL_STIFFNESS,
    TRANSLATIONAL_STIFFNESS,
    ServiceLimits,
    check_load,
    check_ranges,
)
from station.hw.franka.arm.transform_check import check_transform
from station.hw.franka.commands.arm_guard import slowed
from station.hw.franka.fci.server.session import ClientSession
from station.hw.franka.fci.wire.messages import Request
from station.hw.franka.fci.wire.robot_protocol import (
    MERGED_INTO,
    NO_CONTROLLER,
    NO_GENERATOR,
    PANDA,
    Command,
    MoveController,
    MoveGenerator,
    RobotProtocol,
    Status,
)
from station.hw.franka.fci.wire.state_numbers import StateNumbers

NO_FILTER = 1000.0
"""Cutoff frequency with which a filter of the arm does nothing [Hz]. Source:
libfranka@0.9.2 include/franka/lowpass_filter.h, kMaxCutoffFrequency."""
SHORTEST_WAIT = 0.5
"""Part of a cycle of the arm in which a client can always answer, even if the arm is
late."""

_LIMITS = ServiceLimits()


def _set_collision_behavior(arm: RobotArm, values: Mapping[str, Any]) -> None:
    behavior = CollisionBehavior(**values)
    check_collision_behavior(behavior)
    arm.set_collision_behavior(behavior)


def _set_joint_impedance(arm: RobotArm, values: Mapping[str, Any]) -> None:
    stiffness = check_ranges(values["K_theta"], [JOINT_STIFFNESS] * 7, "K_theta")
    arm.set_joint_impedance(stiffness)


def _set_cartesian_impedance(arm: RobotArm, values: Mapping[str, Any]) -> None:
    ranges = [TRANSLATIONAL_STIFFNESS] * 3 + [ROTATIONAL_STIFFNESS] * 3
    arm.set_cartesian_impedance(check_ranges(values["K_x"], ranges, "K_x"))


def _set_guiding_mode(_arm: RobotArm, values: Mapping[str, Any]) -> None:
    if not all(values["guiding_mode"]):
        raise InvalidCommandError("A simulated arm is guided in all directions alone.")


def _set_ee_to_k(arm: RobotArm, values: Mapping[str, Any]) -> None:
    arm.set_stiffness_frame(check_transform(values["EE_T_K"], "EE_T_K"))


def _set_ne_to_ee(arm: RobotArm, values: Mapping[str, Any]) -> None:
    arm.set_end_effector_frame(check_transform(values["NE_T_EE"], "NE_T_EE"))


def _set_load(arm: RobotArm, values: Mapping[str, Any]) -> None:
    mass, center, inertia = values["m_load"], values["F_x_Cload"], values["I_load"]
    check_load(mass, center, inertia, _LIMITS)
    arm.set_load(RigidBody(mass, center, inertia))


def _set_filters(_arm: RobotArm, values: Mapping[str, Any]) -> None:
    if any(frequency != NO_FILTER for frequency in values.values()):
        raise InvalidCommandError(f"A simulated arm filters with {NO_FILTER} Hz alone.")


SETTERS: Mapping[Command, Callable[[RobotArm, Mapping[str, Any]], None]] = {
    Command.SET_COLLISION_BEHAVIOR: _set_collision_behavior,
    Command.SET_JOINT_IMPEDANCE: _set_joint_impedance,
    Command.SET_CARTESIAN_IMPEDANCE: _set_cartesian_impedance,
    Command.SET_GUIDING_MODE: _set_guiding_mode,
    Command.SET_EE_TO_K: _set_ee_to_k,
    Command.SET_NE_TO_EE: _set_ne_to_ee,
    Command.SET_LOAD: _set_load,
    Command.SET_FILTERS: _set_filters,
}
"""Function that changes each setting of the arm: `setter(arm, fields of the request)`.

Each raises `InvalidCommandError` for impossible values, and `ArmCommandError` when the
arm cannot change the setting now."""


class StateWriter:
    """Keeps one message and brings it up to date in place. Control thread.

    The fields of the message are those of `RobotState`; libfranka calls the flags of
    the present errors `errors` on the wire, and those of the last motion
    `reflex_reason`.

    Args:
        arm: The arm.
        protocol: The version of the protocol.

    Attributes:
        message: The message.
    """

    def __init__(self, arm: RobotArm, protocol: RobotProtocol) -> None:
        self._arm, self._layout = arm, protocol.state
        self.message = bytearray(self._layout.size)
        self._numbers = StateNumbers(self._layout, self.message, arm.state)
        self._merged = [ERROR_INDEX[name] for name in protocol.merged_errors]

    def write(self, message_id: int, generator: int, controller: int) -> bytearray:
        """Bring `message` up to date with the arm's state, and return it.

        Args:
            message_id: Number of the message, which grows by 1 per cycle.
            generator: `motion_generator_mode` on the wire.
            controller: `controller_mode` on the wire.
        """
        state, message, places = self._arm.state, self.message, self._layout.offsets
        self._layout.write(message, "message_id", message_id)
        self._numbers.write()
        top, bottom = self._numbers.accelerations
        if top.size and (readings := self._arm.accelerometers()):
            top[:], bottom[:] = readings
        message[places["motion_generator_mode"]] = generator
        message[places["controller_mode"]] = controller
        message[places["robot_mode"]] = state.robot_mode.value
        for name, flags in (
            ("errors", state.current_errors),
            ("reflex_reason", state.last_motion_errors),
        ):
            raised = bytearray(flags)
            for merged in self._merged:
                raised[ERROR_INDEX[MERGED_INTO]] |= raised[merged]
                raised[merged] = False
            message[places[name] : places[name] + len(raised)] = raised
        return message


@dataclass(frozen=True, slots=True)
class ClientFeatures:
    """The versions that clients of an arm may speak, and the models that they get.

    Attributes:
        protocols: The versions, the arm's own last; see `ClientSession`.
        libraries: Model libraries, by the `Architecture` and the `System` of a client.
        robot_model: The URDF of the arm; empty if there is none.
    """

    protocols: Sequence[RobotProtocol] = (PANDA,)
    libraries: Mapping[tuple[int, int], bytes] = field(default_factory=dict)
    robot_model: str = ""


_ENDS = {
    RobotMode.REFLEX: Status.REFLEX_ABORTED,
    RobotMode.USER_STOPPED: Status.EMERGENCY_ABORTED,
    RobotMode.IDLE: Status.PREEMPTED,
}
_RECOVERIES = {
    RobotMode.IDLE: Status.SUCCESS,
    RobotMode.REFLEX: Status.REFLEX_ABORTED,
    RobotMode.USER_STOPPED: Status.EMERGENCY_ABORTED,
}
_REJECTIONS = {
    SingularStartError: Status.START_AT_SINGULAR_POSE_REJECTED,
    ArmCommandError: Status.COMMAND_NOT_POSSIBLE_REJECTED,
    InvalidCommandError: Status.INVALID_ARGUMENT_REJECTED,
}


class RobotSession(ClientSession[Command]):
    """Serves one client of an arm. Control thread.

    Calls per cycle of the arm: `before_cycle`, the arm's `read_once`, `after_cycle`,
    and then `state` once. `receive` and `receive_command` are called in between, with
    the bytes that have arrived.

    Args:
        arm: The arm.
        features: The versions that are spoken, and the models.
        is_free: Returns whether this client may move the arm.
    """

    def __init__(
        self,
        arm: RobotArm,
        features: ClientFeatures,
        is_free: Callable[[], bool] = lambda: True,
    ) -> None:
        self._arm = arm  # whose state `_speak` writes
        super().__init__(features.protocols)
        self._features, self._is_free = features, is_free
        self._motion: Request[Command] | None = None
        self._waiting: Request[Command] | None = None  # until the arm is at rest
        self._generator, self._controller = NO_GENERATOR, NO_CONTROLLER
        self._recovery: Request[Command] | None = None
        self._command: Mapping[str, Any] | None = None
        self._answered = 0  # message_id of the newest command
        self._is_finishing = False
        self._reason = ""
        # Largest velocities of a motion that the arm plans itself; None in others.
        self._fastest: Sequence[float] | None = None

    @property
    def is_moving(self) -> bool:
        """Return whether this client's motion runs."""
        return self._motion is not None

    @property
    def misses_command(self) -> bool:
        """Return whether the client owes a command that has not arrived yet."""
        return self.is_answering and self._command is None

    @property
    def is_answering(self) -> bool:
        """Return whether the client owes a command to every cycle of its motion.

        The client does so from its first command on, unless the arm plans the motion.
        """
        return self._motion is not None and self._answered > 0 and self._fastest is None

    def take_reason(self) -> str:
        """Return the reason for the last refusal once; empty if there is none."""
        reason, self._reason = self._reason, ""
        return reason

    def receive_command(self, datagram: bytes) -> None:
        """Take a UDP datagram; drop it if it is not a newer command.

        Args:
            datagram: The datagram.
        """
        layout = self._protocol.command
        if self._motion is None or len(datagram) != layout.size:
            return
        command = layout.unpack(datagram)
        # Targets of a planned motion may follow each other within a cycle.
        is_planned = self._fastest is not None
        if command["message_id"] + is_planned > self._answered:
            self._answered = command["message_id"]
            self._command = command

    def before_cycle(self) -> bytes:
        """Pass the client's newest command on; return answers that became due."""
        command, self._command = self._command, None
        if command is None or self._arm.state.robot_mode is not RobotMode.MOVE:
            return b""
        self._is_finishing = command["motion_generation_finished"] or command.get(
            "torque_command_finished", False
        )
        try:
            self._send(command)
        except InvalidCommandError:
            self._arm.stop_motion()
            return self._end_motion(Status.INPUT_ERROR_ABORTED)
        return b""

    def after_cycle(self) -> bytes:
        """Return the answers that the new state of the arm makes due."""
        answers, mode = b"", self._arm.state.robot_mode
        if mode is not RobotMode.MOVE:
            answers = self._end_motion(_ENDS.get(mode, Status.ABORTED))
        elif self._is_finishing:
            self._arm.stop_motion()
            answers = self._end_motion(Status.SUCCESS)
        if self._waiting is not None:
            answers += self._serve(self._waiting)
        return answers + self._advance_recovery()

    def state(self, message_id: int) -> bytearray:
        """Return the arm's state as a message; the same memory at every call.

        Args:
            message_id: Number of the message, which grows by 1 per cycle of the arm.
        """
        return self._writer.write(message_id, self._generator, self._controller)

    def preempt(self) -> bytes:
        """Take the arm away from the client; return the answer that ends its motion."""
        return self._end_motion(Status.PREEMPTED)

    def close(self) -> None:
        """End the motion of the departed client."""
        if self._motion is not None:
            self._arm.stop_motion()
            self._end_motion(Status.ABORTED)

    @override
    def _serve(self, request: Request[Command]) -> bytes:
        try:
            return self._carry_out(request)
        except (ArmCommandError, InvalidCommandError) as error:
            self._reason = f"{request.command.name} is refused: {error.message}"
            told = (one for kind, one in _REJECTIONS.items() if isinstance(error, kind))
            return self._say(request, next(told))

    def _carry_out(self, request: Request[Command]) -> bytes:
        """Carry a request out; return the answers that are due.

        Raises:
            ArmCommandError: The request is not possible now.
            InvalidCommandError: The request is never possible.
        """
        serve = {
            Command.MOVE: self._start_motion,
            Command.STOP_MOVE: self._stop_motion,
            Command.GET_CARTESIAN_LIMIT: self._cartesian_limit,
            Command.AUTOMATIC_ERROR_RECOVERY: self._recover,
            Command.LOAD_MODEL_LIBRARY: self._load_library,
            Command.GET_ROBOT_MODEL: self._tell_model,
        }
        return serve.get(request.command, self._change_setting)(request)

    @override
    def _speak(self, protocol: RobotProtocol) -> None:
        super()._speak(protocol)
        self._writer = StateWriter(self._arm, protocol)

    def _tell_precision(self, *, is_single: bool) -> None:
        simulation = self._arm.simulation()
        if simulation is not None:
            simulation.set_state_precision(is_single=is_single)

    def _start_motion(self, request: Request[Command]) -> bytes:
        values, self._waiting = request.values, None
        if problem := self._problem_of(values):
            raise InvalidCommandError(problem)
        controller = MoveController(values["controller_mode"])
        generator = MoveGenerator(values["motion_generator_mode"])
        is_planned = values.get("use_async_motion_generator")
        fastest = values["maximum_velocity"] if is_planned else None
        if not self._is_free():
            raise ArmCommandError(
                "The controllers of the station command the arm, or the station is "
                "stopped."
            )
        # A command made from a state of an arm that still slows down would be a jump.
        if (state := self._arm.state).robot_mode is RobotMode.IDLE and any(state.dq_d):
            self._waiting = request
            return b""
        self._tell_precision(is_single=self._protocol.is_single)
        self._arm.start_motion(
            ControllerMode[controller.name], MotionGeneratorMode[generator.name]
        )
        self._motion, self._command, self._fastest = request, None, fastest
        self._answered, self._is_finishing = 0, False
        self._generator, self._controller = 1 + generator, controller
        return self._say(request, Status.MOTION_STARTED)

    def _problem_of(self, values: Mapping[str, Any]) -> str | None:
        """Return the reason why no arm can make such a motion; None if an arm can."""
        controller = values["controller_mode"]
        generator = values["motion_generator_mode"]
        if controller not in list(MoveController):
            return f"There is no controller mode {controller}."
        if generator not in self._protocol.generators:
            version = self._protocol.version
            return f"Version {version} has no motion generator mode {generator}."
        for name in ("maximum_path_deviation", "maximum_goal_pose_deviation"):
            if not all(0.0 <= value < inf for value in values[name]):
                return "A deviation is negative or not finite."
        if not values.get("use_async_motion_generator"):
            return None
        if (
            generator != MoveGenerator.JOINT_POSITION
            or controller == MoveController.EXTERNAL_CONTROLLER
        ):
            return "The arm plans joint positions with a controller of its own alone."
        if not all(0.0 < value < inf for value in values["maximum_velocity"]):
            return "A maximum velocity is not above 0 or not finite."
        return None

    def _stop_motion(self, request: Request[Command]) -> bytes:
        answers, mode = b"", self._arm.state.robot_mode
        if self._waiting is not None:
            answers, self._waiting = self._say(self._waiting, Status.PREEMPTED), None
        if self._motion is not None and mode is RobotMode.MOVE:
            self._arm.stop_motion()
            answers = self._end_motion(Status.PREEMPTED)
        elif mode is not RobotMode.IDLE:
            return self._say(request, Status.COMMAND_NOT_POSSIBLE_REJECTED)
        return answers + self._say(request, Status.SUCCESS)

    def _change_setting(self, request: Request[Command]) -> bytes:
        if self._arm.state.robot_mode is RobotMode.MOVE:
            raise ArmCommandError("The arm moves.")
        SETTERS[request.command](self._arm, request.values)
        return self._say(request, Status.SUCCESS)

    def _cartesian_limit(self, request: Request[Command]) -> bytes:
        """Answer that there are no virtual walls: a simulated arm has none."""
        wall = {"object_frame": IDENTITY}
        return self._say(request, Status.SUCCESS, wall)

    def _recover(self, request: Request[Command]) -> bytes:
        if self._arm.state.robot_mode is RobotMode.MOVE or self._recovery is not None:
            return self._say(request, Status.COMMAND_NOT_POSSIBLE_REJECTED)
        self._arm.automatic_error_recovery()
        self._recovery = request
        return self._advance_recovery()

    def _advance_recovery(self) -> bytes:
        request, mode = self._recovery, self._arm.state.robot_mode
        if request is None or mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            return b""
        self._recovery = None
        return self._say(request, _RECOVERIES.get(mode, Status.ABORTED))

    def _load_library(self, request: Request[Command]) -> bytes:
        machine = request.values["architecture"], request.values["system"]
        library = self._features.libraries.get(machine, b"")
        status = Status.SUCCESS if library else Status.ERROR
        return self._say(request, status, tail=library)

    def _tell_model(self, request: Request[Command]) -> bytes:
        urdf = self._features.robot_model.encode()
        status = Status.SUCCESS if urdf else Status.COMMAND_NOT_POSSIBLE_REJECTED
        return self._say(request, status, tail=urdf)

    def _end_motion(self, status: Status) -> bytes:
        request, self._motion = self._motion, None
        self._generator, self._controller = NO_GENERATOR, NO_CONTROLLER
        self._command, self._is_finishing = None, False
        self._fastest = None
        if request is None:
            return b""
        self._tell_precision(is_single=False)
        return self._say(request, status)

    def _send(self, command: Mapping[str, Any]) -> None:
        """Pass a command on to the arm.

        Raises:
            InvalidCommandError: A number is not finite, a pose is not a transform, or
                the arm has to stop at once to stay clear of its scene.
        """
        arm = self._arm
        if self._fastest is not None:
            if not self._is_finishing:  # the last command of a planned motion has none
                arm.plan_joint_positions([*command["q_c"]], self._fastest)
            return
        guard = arm.guard

        def clear(field: str) -> list[float]:
            values = [*command[field]]
            return values if guard is None else slowed(guard, field, values)

        if self._controller == MoveController.EXTERNAL_CONTROLLER:
            arm.command_joint_torques(clear("tau_J_d"))
        elbow = [*command["elbow_c"]] if command["valid_elbow"] else None
        match MoveGenerator(self._generator - 1):
            case MoveGenerator.JOINT_POSITION:
                arm.command_joint_positions(clear("q_c"))
            case MoveGenerator.JOINT_VELOCITY:
                arm.command_joint_velocities(clear("dq_c"))
            case MoveGenerator.CARTESIAN_POSITION:
                arm.command_cartesian_pose(clear("O_T_EE_c"), elbow)
            case MoveGenerator.CARTESIAN_VELOCITY:
                arm.command_cartesian_velocity(clear("O_dP_EE_c"), elbow)
