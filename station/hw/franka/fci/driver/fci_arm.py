"""An arm behind the Franka Control Interface.

Source: libfranka@0.9.2 src/robot_impl.cpp, Robot::Impl; differs: a motion is stopped
without waiting for the end of the stop, and what the arm answers in a cycle is looked
at in a later one, because the control thread waits for nothing but the next state.
"""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from math import pi
from typing import Any

from typing_extensions import override

from station.core.errors import ArmCommandError, InvalidCommandError, StationError
from station.core.franka.arm_simulation import ArmSimulation
from station.core.franka.franka_errors import ArmError, error_names
from station.core.franka.franka_model import FrankaModel
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import ArmRecord, CollisionBehavior
from station.hw.franka.arm.load import Load
from station.hw.franka.arm.robot_arm import (
    REST_VELOCITY,
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
)
from station.hw.franka.fci.driver.command_writer import CommandWriter
from station.hw.franka.fci.driver.motion_log import MotionLog
from station.hw.franka.fci.driver.network import (
    SLICE,
    UDP_TIMEOUT,
    FciNetworkError,
    Network,
)
from station.hw.franka.fci.driver.realtime import realtime_problem
from station.hw.franka.fci.driver.refusals import refusal_of
from station.hw.franka.fci.driver.robot_client import RobotAnswer, RobotClient
from station.hw.franka.fci.driver.state_reader import StateReader
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import (
    PANDA,
    Command,
    MoveController,
    MoveGenerator,
    MoveStatus,
    RecoveryStatus,
    RobotProtocol,
    SetterStatus,
)
from station.kernel.doubles import Storage

MEASURED_REST = 0.02
"""Joints that are measured slower than this are at rest [rad/s]: the noise of a real
arm's velocities is 3 mrad/s (see `Realism`)."""
CYCLE_TIME = 0.001
"""Time from one state to the next [s]."""

_DEVIATIONS = (10.0, 3.12, 2.0 * pi)
"""Source: libfranka@0.9.2 src/control_loop.h, kDefaultDeviation."""
_LONGEST_START = 1000
"""States within which a motion that the arm has accepted shows."""
_CONTROLLERS = dict(zip(ControllerMode, MoveController, strict=True))
_GENERATORS = {MotionGeneratorMode[g.name]: g for g in MoveGenerator}
# Torques alone are a motion with joint velocities that are zero, as in libfranka.
_GENERATORS[MotionGeneratorMode.NONE] = MoveGenerator.JOINT_VELOCITY
_FIELDS = {
    MotionGeneratorMode.NONE: "tau_J_d",
    MotionGeneratorMode.JOINT_POSITION: "q_c",
    MotionGeneratorMode.JOINT_VELOCITY: "dq_c",
    MotionGeneratorMode.CARTESIAN_POSITION: "O_T_EE_c",
    MotionGeneratorMode.CARTESIAN_VELOCITY: "O_dP_EE_c",
}
_REMEDIES = {
    RobotMode.OTHER: "open the brakes and activate FCI in Desk",
    RobotMode.GUIDING: "let go of the guiding buttons",
    RobotMode.REFLEX: "remove the cause, then recover",
    RobotMode.USER_STOPPED: "release the user stop",
    RobotMode.AUTOMATIC_ERROR_RECOVERY: "wait until the arm is at rest",
}
_TORQUES, _MOTION = 1, 2


class FciArm(RobotArm):
    """Drives an arm over a network. Its states pace the control loop: see `wait`.

    A command leaves as soon as everything that its motion needs is there: torques, the
    motion, or both. It answers the newest state; a cycle has one answer.

    Requests that change something wait for the arm's answer, a few milliseconds, while
    no motion runs. A motion is stopped without waiting.

    An arm that is lost (no state for `UDP_TIMEOUT`, or a broken connection) is in mode
    Other from then on, and `read_once` returns at once.

    Args:
        network: The connection to the arm.
        make_model: Makes a model of the arm.
        is_enforced: Whether a motion needs a real-time thread (`realtime_config`).
        protocol: The version that is spoken.
        find_problem: Returns why a thread is not real-time enough; None if it is.

    Raises:
        FciNetworkError: The arm does not answer.
        FciProtocolError: The arm does not speak this version.
    """

    def __init__(
        self,
        network: Network,
        make_model: Callable[[], FrankaModel],
        *,
        is_enforced: bool = True,
        protocol: RobotProtocol = PANDA,
        find_problem: Callable[[int], str | None] = realtime_problem,
    ) -> None:
        self.cycle_time = CYCLE_TIME
        self.state = RobotState()
        self._network = network
        self._protocol = protocol
        self._make_model = make_model
        self._is_enforced, self._find_problem = is_enforced, find_problem
        self._client = RobotClient(network, protocol)
        self._reader = StateReader(self.state, protocol, self.cycle_time)
        self._writer = CommandWriter(protocol)
        self._controller: ControllerMode | None = None
        self._generator = MotionGeneratorMode.NONE
        self._modes = (0, 0)  # of the running motion, as on the wire
        self._needed = self._given = 0
        self._motion: int | None = None  # the request that began it
        self._ended: int | None = None  # one whose end is still to be explained
        self._stop: int | None = None
        self._recovery: int | None = None
        self._failure = ""  # why the last motion, stop or recovery failed
        self._has_failed = False
        self._log = MotionLog(protocol, "tau_J_d", self.cycle_time)
        self._counted = 0  # message_id up to which `wait` has told
        self._due = 0  # states that `wait` has taken and `read_once` has not
        self._silence = 0.0
        self._lost: str | None = None
        self._thread = threading.get_native_id()
        try:
            self._client.connect()
            self._require_state()
        except StationError:
            network.close()
            raise
        self._counted = self._reader.message_id

    def wait(self) -> int:
        """Wait for the arm's next state, `SLICE` at most; return the elapsed cycles.

        This is the clock of a control loop: 0 when no state has come, more than 1 when
        states were lost or came while the loop did something else. `read_once` then
        returns at once, as often as cycles have elapsed.
        """
        if self._lost is None:
            self._receive()
        elapsed = self._reader.message_id - self._counted
        if self._lost is not None:
            threading.Event().wait(self.cycle_time)
            elapsed = 1  # time passes without an arm, so that controllers are told
        self._counted = self._reader.message_id
        self._due = elapsed
        return elapsed

    @override
    def read_once(self) -> RobotState:
        self._given = 0
        if self._due > 0:
            self._due -= 1
        elif self._lost is None:
            self._receive_in_time()
            self._counted = self._reader.message_id
        if self._stop is not None or self._recovery is not None or self._ended:
            self._take_answers()
        return self.state

    @override
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str | None:
        if self._lost is not None:
            return f"{self._lost}; {self.remedy()}"
        mode = self._shown_mode()
        if mode not in (RobotMode.IDLE, RobotMode.MOVE):
            return f"the arm is in mode {mode.name.lower()}; {self.remedy()}"
        is_external = controller_mode is ControllerMode.EXTERNAL_CONTROLLER
        if motion_generator_mode is MotionGeneratorMode.NONE and not is_external:
            return "the internal controller needs a motion generator"
        problem = self._find_problem(self._thread) if self._is_enforced else None
        if problem is not None:
            return (
                f"{problem}; allow SCHED_FIFO and boot a real-time kernel, or set "
                "realtime_config: ignore (see docs/real_arm.md)"
            )
        return None

    @override
    def is_at_rest(self) -> bool:
        state = self.state
        return (
            not self.is_stopping()
            and all(abs(dq) < REST_VELOCITY for dq in state.doubles("dq_d"))
            and all(abs(dq) < MEASURED_REST for dq in state.doubles("dq"))
        )

    @override
    def is_stopping(self) -> bool:
        if self._stop is not None:
            self._take_answers()
        return self._stop is not None

    @override
    def start_motion(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> None:
        self._thread = threading.get_native_id()
        reason = self.refusal(controller_mode, motion_generator_mode)
        if self._motion is not None:
            reason = "a motion runs already"
        elif self.is_stopping():
            reason = "the last motion is still coming to rest"
        if reason is not None:
            raise ArmCommandError(
                f"The arm cannot start a motion: {reason}.",
                remedy="Stop the running motion, recover, or ask for other modes.",
            )
        controller = _CONTROLLERS[controller_mode]
        generator = _GENERATORS[motion_generator_mode]
        answer = self._ask(
            Command.MOVE,
            {
                "controller_mode": controller,
                "motion_generator_mode": generator,
                "maximum_path_deviation": _DEVIATIONS,
                "maximum_goal_pose_deviation": _DEVIATIONS,
            },
        )
        if answer.status != MoveStatus.MOTION_STARTED:
            raise self._refused(answer)
        self._motion, self._modes = answer.command_id, (1 + generator, controller)
        self._controller, self._generator = controller_mode, motion_generator_mode
        is_external = controller_mode is ControllerMode.EXTERNAL_CONTROLLER
        moves = motion_generator_mode is not MotionGeneratorMode.NONE
        self._needed = _TORQUES * is_external + _MOTION * moves
        self._writer.clear()
        self._failure, self._has_failed, self._given = "", False, 0
        field = _FIELDS[motion_generator_mode]
        self._log = MotionLog(self._protocol, field, self.cycle_time)
        self._await_motion()

    @override
    def stop_motion(self) -> None:
        if self._motion is None:
            return
        self._ended, self._motion = None, None
        self._end_motion()
        try:
            self._stop = self._client.send(Command.STOP_MOVE)
        except FciNetworkError as error:
            self._lose(error)
        else:
            self._show_mode()
            self._take_answers()

    @override
    def command_joint_torques(self, tau: Storage) -> None:
        if self._controller is not ControllerMode.EXTERNAL_CONTROLLER:
            raise self._not_commandable("joint torques")
        self._writer.torques(tau)
        self._give(_TORQUES)

    @override
    def command_joint_positions(self, q: Storage) -> None:
        self._check_generator(MotionGeneratorMode.JOINT_POSITION, "joint positions")
        self._writer.joints("q_c", q)
        self._give(_MOTION)

    @override
    def command_joint_velocities(self, dq: Storage) -> None:
        self._check_generator(MotionGeneratorMode.JOINT_VELOCITY, "joint velocities")
        self._writer.joints("dq_c", dq)
        self._give(_MOTION)

    @override
    def command_cartesian_pose(
        self, pose: Storage, elbow: list[float] | None = None
    ) -> None:
        self._check_generator(MotionGeneratorMode.CARTESIAN_POSITION, "Cartesian pose")
        self._writer.cartesian("O_T_EE_c", pose, elbow)
        self._give(_MOTION)

    @override
    def command_cartesian_velocity(
        self, twist: Storage, elbow: list[float] | None = None
    ) -> None:
        generator = MotionGeneratorMode.CARTESIAN_VELOCITY
        self._check_generator(generator, "Cartesian velocity")
        self._writer.cartesian("O_dP_EE_c", twist, elbow)
        self._give(_MOTION)

    @override
    def load_model(self) -> FrankaModel:
        return self._make_model()

    @override
    def refresh_state(self) -> None:
        """Do nothing: the arm sends every field in every cycle."""

    @override
    def set_joint_impedance(self, stiffness: Sequence[float]) -> None:
        self._set(Command.SET_JOINT_IMPEDANCE, {"K_theta": stiffness})

    @override
    def set_cartesian_impedance(self, stiffness: Sequence[float]) -> None:
        self._set(Command.SET_CARTESIAN_IMPEDANCE, {"K_x": stiffness})

    @override
    def set_end_effector_frame(self, frame: Sequence[float]) -> None:
        self._set(Command.SET_NE_TO_EE, {"NE_T_EE": frame})

    @override
    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        self._set(Command.SET_EE_TO_K, {"EE_T_K": frame})

    @override
    def set_load(self, load: Load) -> None:
        values = {
            "m_load": load.mass,
            "F_x_Cload": load.center_of_mass,
            "I_load": load.inertia,
        }
        self._set(Command.SET_LOAD, values)

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._set(Command.SET_COLLISION_BEHAVIOR, asdict(behavior))

    @override
    def check_recovery(self) -> None:
        if self._lost is not None:
            raise ArmCommandError(
                f"The arm cannot recover: {self._lost}.",
                remedy="Restore the connection and restart the station.",
            )
        if self.state.robot_mode is RobotMode.USER_STOPPED:
            raise ArmCommandError(
                "The arm cannot recover: the user stop is pressed.",
                remedy="Release the user stop.",
            )

    @override
    def automatic_error_recovery(self) -> None:
        self.check_recovery()
        if self.state.robot_mode is not RobotMode.REFLEX or self._recovery is not None:
            return
        self._failure = ""
        try:
            self._recovery = self._client.send(Command.AUTOMATIC_ERROR_RECOVERY)
        except FciNetworkError as error:
            raise self._lose(error) from error

    @override
    def errors(self) -> list[ArmError]:
        names = error_names(self.state.current_errors)
        if not names and self._has_failed:
            names = error_names(self.state.last_motion_errors)
        cycle = self._reader.message_id
        return [ArmError(name, "", 0.0, 0.0, "", cycle) for name in names]

    @override
    def failure(self) -> str:
        return self._lost or self._failure

    @override
    def log(self) -> list[ArmRecord]:
        return self._log.records() if self._has_failed else []

    @override
    def remedy(self) -> str | None:
        if self._lost is not None:
            return "restore the connection and restart the station"
        todo = _REMEDIES.get(self._shown_mode())
        if todo is None or not self._failure:
            return todo
        return f"{todo} ({self._failure})"

    @override
    def simulation(self) -> ArmSimulation | None:
        return None

    def close(self) -> None:
        """Stop a motion and hang up."""
        self.stop_motion()
        self._network.close()

    def _receive(self) -> bool:
        """Wait for a newer state, `SLICE` at most; return whether one has come.

        States that have piled up are passed over, as in libfranka.
        """
        reader, network = self._reader, self._network
        size = network.wait(reader.message)
        if not reader.is_newer(size):
            if not size:
                self._note_silence()
            return False
        self._read()
        if reader.message_id > self._counted + 1:
            while size := network.poll(reader.message):
                if reader.is_newer(size):
                    self._read()
        return True

    def _read(self) -> None:
        reader = self._reader
        reader.read()
        self._silence = 0.0
        if self._motion is not None:
            self._log.note(reader.message, self._writer.message)
            if reader.robot_mode is not RobotMode.MOVE or reader.modes != self._modes:
                self._ended, self._motion = self._motion, None
                self._has_failed = True
                self._end_motion()
        self._show_mode()

    def _receive_in_time(self) -> None:
        """Wait for the next state, as long as an arm may be silent."""
        while self._lost is None and not self._receive():
            pass

    def _require_state(self) -> None:
        """Wait for a state; fail without one.

        Raises:
            FciNetworkError: The arm is lost.
        """
        self._receive_in_time()
        if self._lost is not None:
            raise FciNetworkError(
                self._lost,
                remedy="Let UDP datagrams of the arm through the firewall.",
            )

    def _note_silence(self) -> None:
        self._silence += SLICE
        if self._silence >= UDP_TIMEOUT:
            self._lose(FciNetworkError("libfranka: UDP receive: Timeout"))

    def _lose(self, error: StationError) -> ArmCommandError:
        """Give the arm up; return what a caller is told."""
        self._lost = error.message
        self._motion = self._ended = self._stop = self._recovery = None
        self._has_failed = True
        self._end_motion()
        self.state.robot_mode = RobotMode.OTHER
        return ArmCommandError(
            f"The arm is lost: {self._lost}.",
            remedy="Restore the connection and restart the station.",
        )

    def _shown_mode(self) -> RobotMode:
        """Return the arm's mode; a motion that nobody here commands is none."""
        if self._lost is not None:
            return RobotMode.OTHER
        mode = self._reader.robot_mode
        if mode is RobotMode.MOVE and self._motion is None:
            return RobotMode.IDLE
        return mode

    def _show_mode(self) -> None:
        mode = self._shown_mode()
        if mode is not self.state.robot_mode:
            self.state.robot_mode = mode

    def _end_motion(self) -> None:
        self._controller, self._generator = None, MotionGeneratorMode.NONE
        self._needed = 0

    def _await_motion(self) -> None:
        """Wait until the states show the motion that the arm has accepted.

        Raises:
            ArmCommandError: The motion has ended before it began, or does not show.
        """
        reader = self._reader
        motion, self._motion = self._motion, None
        for _ in range(_LONGEST_START):
            if self._lost is not None or motion is None:
                break
            if reader.modes == self._modes and reader.robot_mode is RobotMode.MOVE:
                self._motion = motion
                self._show_mode()
                return
            self._receive_in_time()
            end = self._client.take(motion)
            if end is not None:
                self._end_motion()
                raise self._refused(end)
        self._end_motion()
        raise ArmCommandError("The arm does not show the motion that it has accepted.")

    def _take_answers(self) -> None:
        """Look whether the arm has answered what it was asked before."""
        try:
            if self._stop is not None:
                stop = self._client.take(self._stop)
                if stop is not None:
                    self._stop = None
                    self._note_failure(stop)
            if self._recovery is not None:
                recovery = self._client.take(self._recovery)
                if recovery is not None:
                    self._recovery = None
                    self._note_failure(recovery)
            if self._ended is not None:
                end = self._client.take(self._ended)
                if end is not None:
                    self._ended = None
                    self._note_failure(end)
        except (FciNetworkError, FciProtocolError) as error:
            self._lose(error)

    def _note_failure(self, answer: RobotAnswer) -> None:
        if answer.status != RecoveryStatus.SUCCESS:  # 0 for every command
            self._failure = refusal_of(
                answer.command, answer.status, self._reader.robot_mode
            )

    def _give(self, part: int) -> None:
        """Note a part of the cycle's command; send when nothing is missing."""
        self._given |= part
        if self._given == self._needed and not self._due:
            self._writer.number(self._reader.message_id)
            self._network.send_datagram(self._writer.message)

    def _set(self, command: Command, values: Mapping[str, Any]) -> None:
        """Change a setting, and wait for a state that shows it.

        Raises:
            ArmCommandError: A motion runs, or the arm is lost or refuses.
            InvalidCommandError: The arm refuses the value.
        """
        if self._motion is not None:
            raise ArmCommandError(
                f"{command.name} is not possible while a motion runs.",
                remedy="Stop the controllers of this arm first.",
            )
        answer = self._ask(command, values)
        if answer.status == SetterStatus.INVALID_ARGUMENT_REJECTED:
            raise InvalidCommandError(
                refusal_of(command, answer.status, self._reader.robot_mode),
                remedy="Give values that this arm allows.",
            )
        if answer.status != SetterStatus.SUCCESS:
            raise self._refused(answer)
        self._receive_in_time()

    def _ask(self, command: Command, values: Mapping[str, Any]) -> RobotAnswer:
        """Ask for something and return the first answer.

        Raises:
            ArmCommandError: The arm is lost.
        """
        if self._lost is not None:
            raise self._lose(FciNetworkError(self._lost))
        try:
            return self._client.ask(command, values)
        except (FciNetworkError, FciProtocolError) as error:
            raise self._lose(error) from error

    def _refused(self, answer: RobotAnswer) -> ArmCommandError:
        mode = self._reader.robot_mode
        todo = _REMEDIES.get(mode, "stop the running motion, then try again")
        return ArmCommandError(
            refusal_of(answer.command, answer.status, mode),
            remedy=f"{todo[0].upper()}{todo[1:]}.",
        )

    def _check_generator(self, generator: MotionGeneratorMode, what: str) -> None:
        if self._generator is not generator:
            raise self._not_commandable(what)

    def _not_commandable(self, what: str) -> ArmCommandError:
        controller = self._controller.value if self._controller else "none"
        return ArmCommandError(
            f"The arm takes no {what}: it is in mode {self.state.robot_mode.name}, "
            f"controller {controller}, motion generator {self._generator.value}.",
            remedy="Start a motion with the fitting modes first.",
        )
