"""A plain arm behind the seam: it follows every command at once, without a simulation.

Tests script what a real arm would do by itself through `fail`.
"""

from collections.abc import Sequence
from math import isfinite

from typing_extensions import override

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import (
    ArmError,
    ArmSimulation,
    CollisionBehavior,
    FrankaModel,
    RobotMode,
    RobotState,
)
from station.core.franka.franka_errors import ERROR_INDEX
from station.core.numerics.poses import displace
from station.hw.franka.arm.franka_kinematics import compose
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import (
    MOST_LOST_PACKETS,
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
)
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.memory.doubles import Storage
from station.reports import ArmRecord
from tests.hw.franka.plain_model import PlainModel

_GENERATORS = {
    MotionGeneratorMode.JOINT_POSITION: 7,
    MotionGeneratorMode.JOINT_VELOCITY: 7,
    MotionGeneratorMode.CARTESIAN_POSITION: 16,
    MotionGeneratorMode.CARTESIAN_VELOCITY: 6,
}


class ScriptedArm(RobotArm):
    """An arm without dynamics whose joints are where they are commanded to be."""

    def __init__(self) -> None:
        self.cycle_time = 0.001
        self.state = RobotState()
        self.state.q = self.state.q_d = INITIAL_POSITIONS
        self.state.robot_mode = RobotMode.IDLE
        self.sent: list[list[float]] = []
        self.behavior: CollisionBehavior | None = None
        self._controller: ControllerMode | None = None
        self._generator = MotionGeneratorMode.NONE
        self._command: list[float] = []
        self._lost = 0
        self.fastest: Sequence[float] | None = None
        self._errors: list[ArmError] = []
        self._recent: list[ArmRecord] = []
        self._log: list[ArmRecord] = []

    def fail(self, name: str) -> None:
        """Stop by an error, as the arm would by itself."""
        self._errors = [ArmError(name, "", 0.0, 0.0, "")]
        self._log, self._recent = self._recent[-50:], []
        self.state.current_errors[ERROR_INDEX[name]] = True
        self._end(RobotMode.REFLEX)

    @override
    def read_once(self) -> RobotState:
        state = self.state
        state.time += self.cycle_time
        state.dq = state.dq_d = [0.0] * 7
        if state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            state.robot_mode = RobotMode.IDLE
        if state.robot_mode is not RobotMode.MOVE or not self.sent:
            return state
        arrived = bool(self._command) or self.fastest is not None
        self._lost = 0 if arrived else self._lost + 1
        if self._lost >= MOST_LOST_PACKETS:
            self.fail("communication_constraints_violation")
        elif self._command:
            self._follow(self._command)
        return state

    def _follow(self, command: list[float]) -> None:
        state, self._command = self.state, []
        match self._generator:
            case MotionGeneratorMode.JOINT_POSITION:
                state.q = state.q_d = command
            case MotionGeneratorMode.JOINT_VELOCITY:
                state.dq = state.dq_d = command
                state.q = state.q_d = [
                    q + dq * self.cycle_time
                    for q, dq in zip(state.q, command, strict=True)
                ]
            case MotionGeneratorMode.CARTESIAN_POSITION:
                state.O_T_EE_c = command
            case MotionGeneratorMode.CARTESIAN_VELOCITY:
                state.O_dP_EE_c = command
                shift = [value * self.cycle_time for value in command]
                state.O_T_EE_c = displace(state.O_T_EE_c, shift[:3], shift[3:])
            case MotionGeneratorMode.NONE:
                state.tau_J_d = command
        self._recent.append(
            ArmRecord(
                state.time,
                tuple(state.q),
                tuple(state.dq),
                tuple(state.tau_J),
                tuple(state.q_d),
                tuple(state.tau_J_d),
                tuple(command),
            )
        )

    @override
    def refusal(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> str | None:
        if self.state.robot_mode not in (RobotMode.IDLE, RobotMode.MOVE):
            return f"the arm is in mode {self.state.robot_mode.name.lower()}"
        is_external = controller_mode is ControllerMode.EXTERNAL_CONTROLLER
        if motion_generator_mode is MotionGeneratorMode.NONE and not is_external:
            return "the internal controller needs a motion generator"
        return None

    @override
    def is_at_rest(self) -> bool:
        return not any(self.state.dq)

    @override
    def start_motion(
        self,
        controller_mode: ControllerMode,
        motion_generator_mode: MotionGeneratorMode,
    ) -> None:
        reason = self.refusal(controller_mode, motion_generator_mode)
        if self.state.robot_mode is RobotMode.MOVE:
            reason = "a motion runs already"
        if reason is not None:
            raise ArmCommandError(f"The arm cannot start a motion: {reason}.")
        self._controller, self._generator = controller_mode, motion_generator_mode
        self._errors, self.sent, self._lost = [], [], 0
        self.fastest = None
        self.refresh_state()
        self.state.O_T_EE_c = self.state.O_T_EE
        self.state.robot_mode = RobotMode.MOVE

    @override
    def stop_motion(self) -> None:
        if self.state.robot_mode is RobotMode.MOVE:
            self._end(RobotMode.IDLE)

    def _end(self, mode: RobotMode) -> None:
        self.state.robot_mode = mode
        self._controller, self._generator = None, MotionGeneratorMode.NONE
        self._command = []

    def _take(self, values: list[float], size: int) -> None:
        if len(values) != size or not all(map(isfinite, values)):
            raise InvalidCommandError(f"{values} are not {size} finite numbers.")
        self._command = list(values)
        self.sent.append(list(values))

    def _take_motion(
        self,
        values: list[float],
        generator: MotionGeneratorMode,
        elbow: list[float] | None = None,
    ) -> None:
        if self._generator is not generator:
            raise ArmCommandError(f"The arm does not move by {generator.value}.")
        if elbow is not None and (len(elbow) != 2 or abs(elbow[1]) != 1.0):
            raise InvalidCommandError(f"An elbow of {elbow} is not possible.")
        self._take(values, _GENERATORS[generator])

    @override
    def command_joint_torques(self, tau: list[float]) -> None:
        if self._controller is not ControllerMode.EXTERNAL_CONTROLLER:
            raise ArmCommandError("The arm does not follow torques.")
        self._take(tau, 7)

    @override
    def command_joint_positions(self, q: list[float]) -> None:
        self._take_motion(q, MotionGeneratorMode.JOINT_POSITION)

    @override
    def plan_joint_positions(self, q: Storage, fastest: Sequence[float]) -> None:
        self._take_motion(q, MotionGeneratorMode.JOINT_POSITION)
        self.fastest = fastest

    @override
    def command_joint_velocities(self, dq: list[float]) -> None:
        self._take_motion(dq, MotionGeneratorMode.JOINT_VELOCITY)

    @override
    def command_cartesian_pose(
        self, pose: Storage, elbow: list[float] | None = None
    ) -> None:
        self._take_motion(pose, MotionGeneratorMode.CARTESIAN_POSITION, elbow)

    @override
    def command_cartesian_velocity(
        self, twist: Storage, elbow: list[float] | None = None
    ) -> None:
        self._take_motion(twist, MotionGeneratorMode.CARTESIAN_VELOCITY, elbow)

    @override
    def load_model(self) -> FrankaModel:
        return PlainModel()

    @override
    def refresh_state(self) -> None:
        state = self.state
        state.O_T_EE = PlainModel().end_effector(state.q, state.F_T_EE)
        state.O_T_EE_d = PlainModel().end_effector(state.q_d, state.F_T_EE)

    @override
    def set_joint_impedance(self, stiffness: Sequence[float]) -> None:
        self._refuse_while_moving()

    @override
    def set_cartesian_impedance(self, stiffness: Sequence[float]) -> None:
        self._refuse_while_moving()

    @override
    def set_end_effector_frame(self, frame: Sequence[float]) -> None:
        self._refuse_while_moving()
        self.state.NE_T_EE = frame
        self.state.F_T_EE = compose(self.state.F_T_NE, frame)

    @override
    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        self._refuse_while_moving()
        self.state.EE_T_K = frame

    @override
    def set_load(self, load: RigidBody) -> None:
        self._refuse_while_moving()
        self.state.m_load = load.mass
        self.state.m_total = self.state.m_ee + load.mass

    @override
    def set_collision_behavior(self, behavior: CollisionBehavior) -> None:
        self._refuse_while_moving()
        self.behavior = behavior

    def _refuse_while_moving(self) -> None:
        if self.state.robot_mode is RobotMode.MOVE:
            raise ArmCommandError("Nothing can be set while a motion runs.")

    @override
    def check_recovery(self) -> None:
        if self.state.robot_mode is RobotMode.USER_STOPPED:
            raise ArmCommandError("The user stop is pressed.")

    @override
    def automatic_error_recovery(self) -> None:
        self.check_recovery()
        if self.state.robot_mode is RobotMode.REFLEX:
            self.state.current_errors[:] = [False] * len(self.state.current_errors)
            self._errors = []
            self.state.robot_mode = RobotMode.AUTOMATIC_ERROR_RECOVERY

    @override
    def errors(self) -> list[ArmError]:
        return list(self._errors)

    @override
    def log(self) -> list[ArmRecord]:
        return list(self._log)

    @override
    def remedy(self) -> str | None:
        free = (RobotMode.IDLE, RobotMode.MOVE)
        return None if self.state.robot_mode in free else "recover"

    @override
    def simulation(self) -> ArmSimulation | None:
        return None
