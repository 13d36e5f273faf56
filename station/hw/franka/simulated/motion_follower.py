"""Receive, check and follow the commands of a motion, and count the missing ones.

Source: Franka Control Interface documentation, what happens with lost packets.
"""

from collections import deque
from collections.abc import Sequence
from math import isfinite
from typing import NoReturn

from station.core.errors import InvalidCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS, MotionGeneratorMode
from station.hw.franka.simulated.arm_cycle import ArmCycle
from station.hw.franka.simulated.cartesian_motion import (
    CartesianMotion,
    Elbow,
)
from station.hw.franka.simulated.motion_checks import (
    joint_motion_errors,
    start_position_errors,
    torque_errors,
)
from station.hw.franka.simulated.step_codes import (
    CARTESIAN,
    NO_MOTION,
    POSITIONS,
    VELOCITIES,
)
from station.memory.doubles import Doubles, Storage, doubles, put

_WINDOW = 100
_DOF = 7
_ZEROS = [0.0] * _DOF
_CODES = {
    MotionGeneratorMode.JOINT_POSITION: POSITIONS,
    MotionGeneratorMode.JOINT_VELOCITY: VELOCITIES,
    MotionGeneratorMode.CARTESIAN_POSITION: CARTESIAN,
    MotionGeneratorMode.CARTESIAN_VELOCITY: CARTESIAN,
}
CARTESIAN_GENERATORS = (
    MotionGeneratorMode.CARTESIAN_POSITION,
    MotionGeneratorMode.CARTESIAN_VELOCITY,
)
"""The motion generators that command the end effector."""


class MotionFollower:
    """Lets the desired motion follow the client's commands, one per cycle.

    A cycle in which no command arrives counts as a lost packet: the motion goes on with
    constant acceleration, and torques keep their values. Control thread only.

    Args:
        state: The arm's state.
        cycle: The arithmetic of the arm's cycle, which follows the usual commands.
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.
    """

    def __init__(
        self,
        state: RobotState,
        cycle: ArmCycle,
        limits: ArmLimits,
        period: float,
    ) -> None:
        self._state = state
        self._step = cycle.step
        self._motion = cycle.motion
        self._memory = cycle.memory
        self._log = cycle.log
        self._limits = limits
        self._period = period
        self._end_effector = cycle.cartesian
        self._cartesian = CartesianMotion(state, limits, cycle.cartesian, period)
        self._generator = MotionGeneratorMode.NONE
        self.begin(MotionGeneratorMode.NONE)

    def begin(self, generator: MotionGeneratorMode) -> None:
        """Wait for the first command of a motion.

        Args:
            generator: The kind of motion that is commanded.
        """
        self._generator = generator
        step = self._step
        step.generator = _CODES.get(generator, NO_MOTION)
        step.is_fresh = step.is_begun = step.is_lossy = False
        step.cycle = 0
        put(self._memory.torques, _ZEROS)
        put(self._memory.sent, _ZEROS)
        self._log.command_size = 0
        self._elbow: Elbow | None = None
        self._end_effector.has_elbow = False
        self._lost_in_a_row = 0
        self._losses: deque[int] = deque()
        self._cartesian.begin()

    def command_torques(self, tau: Storage) -> None:
        """Take torques [Nm], shape (7,), for the next cycle.

        Raises:
            InvalidCommandError: Not 7 finite numbers.
        """
        if not self._step.receive(_as_doubles(tau), _DOF, self._memory.torques):
            _refuse("joint torques", _DOF, tau)

    def command_joints(self, values: Storage) -> None:
        """Take positions [rad] or velocities [rad/s], shape (7,), for the next cycle.

        Raises:
            InvalidCommandError: Not 7 finite numbers.
        """
        if not self._step.receive(_as_doubles(values), _DOF, self._memory.target):
            _refuse("joint commands", _DOF, values)

    def command_cartesian(
        self, values: Storage, elbow: Sequence[float] | None, size: int
    ) -> None:
        """Take a pose or a twist for the next cycle.

        Args:
            values: The pose O_T_EE or the twist O_dP_EE.
            elbow: Position of joint 3 [rad] and sign of joint 4, or None.
            size: How many numbers `values` must have.

        Raises:
            InvalidCommandError: `values` are not `size` finite numbers, or the elbow
                is malformed.
        """
        chosen = _checked_elbow(elbow)
        if not self._step.receive_end_effector(_as_doubles(values), size):
            _refuse("a Cartesian command", size, values)
        self._elbow = chosen
        self._end_effector.has_elbow = chosen is not None

    def ignore(self) -> None:
        """Discard this cycle's command and slow down to rest."""
        self._step.is_fresh = False
        self._motion.hold()
        if self._generator in CARTESIAN_GENERATORS:
            self._cartesian.begin()

    def advance(self, *, torques_act: bool, is_lossy: bool) -> list[ArmError]:
        """Advance the desired motion by a cycle; return the errors.

        Args:
            torques_act: Whether the motors follow `torques`.
            is_lossy: Whether the command of this cycle is lost.
        """
        step = self._step
        arrived = step.is_fresh and not is_lossy
        step.is_fresh = False
        if not arrived and not step.is_begun:
            self._motion.hold()
            return []
        self._count(lost=not arrived)
        if self._lost_in_a_row >= MOST_LOST_PACKETS:
            name = "communication_constraints_violation"
            lost, most = float(self._lost_in_a_row), float(MOST_LOST_PACKETS - 1)
            return [ArmError(name, "", lost, most, "commands lost in a row")]
        errors = self._follow_torques(arrived=arrived) if torques_act else []
        if errors:
            return errors
        if self._generator in CARTESIAN_GENERATORS:
            errors = self._follow_cartesian(arrived=arrived)
        elif self._generator is MotionGeneratorMode.NONE:
            self._motion.hold()
        elif arrived:
            errors = self._follow_joints()
        else:
            self._motion.extrapolate()
        step.is_begun = True
        if not errors:
            self._log.note(self._state.time)
        return errors

    def _count(self, *, lost: bool) -> None:
        step = self._step
        step.cycle += 1
        self._lost_in_a_row = self._lost_in_a_row + 1 if lost else 0
        losses = self._losses
        if lost:
            losses.append(step.cycle)
        if losses:
            while losses and losses[0] <= step.cycle - _WINDOW:
                losses.popleft()
            rate = 1.0 - len(losses) / _WINDOW
            self._state.control_command_success_rate = rate
        step.is_lossy = bool(losses)

    def _follow_torques(self, *, arrived: bool) -> list[ArmError]:
        memory = self._memory
        if not arrived:
            put(memory.torques, memory.sent)
            return []
        tau, last = [*memory.torques], self._state.tau_J_d
        errors = torque_errors(tau, last, [*memory.sent], self._limits, self._period)
        put(memory.sent, memory.torques)
        return errors

    def _follow_joints(self) -> list[ArmError]:
        state, period = self._state, self._period
        target = [*self._memory.target]
        is_position = self._generator is MotionGeneratorMode.JOINT_POSITION
        if is_position:
            q = target
            dq = [(new - old) / period for new, old in zip(q, state.q_d, strict=True)]
            errors = [] if self._step.is_begun else start_position_errors(q, state.q_d)
        else:
            dq = target
            q = [old + rate * period for old, rate in zip(state.q_d, dq, strict=True)]
            errors = []
        errors = errors or joint_motion_errors(
            q,
            dq,
            last_dq=state.dq_d,
            last_ddq=state.ddq_d,
            limits=self._limits,
            period=period,
        )
        if not errors and is_position:
            self._motion.follow_positions()
        elif not errors:
            self._motion.follow_velocities()
        return errors

    def _follow_cartesian(self, *, arrived: bool) -> list[ArmError]:
        cartesian = self._cartesian
        if arrived:
            errors = cartesian.plan(
                self._elbow if self._end_effector.has_elbow else None
            )
            if errors:
                return errors
        else:
            cartesian.extrapolate()
        errors = cartesian.solve()
        if not errors:
            self._motion.follow_positions()
        return errors


def _as_doubles(values: Storage) -> Doubles:
    return doubles(values) if isinstance(values, (list, tuple)) else values


def _checked_elbow(elbow: Sequence[float] | None) -> Elbow | None:
    if elbow is None:
        return None
    if len(elbow) != 2 or not isfinite(elbow[0]) or abs(elbow[1]) != 1.0:
        raise InvalidCommandError(
            f"An elbow of {elbow} is not possible.",
            remedy="Give the position of joint 3 and a sign of +1 or -1.",
        )
    return elbow[0], elbow[1]


def _refuse(what: str, size: int, values: Storage) -> NoReturn:
    raise InvalidCommandError(
        f"{what} must be {size} finite numbers, not {[*values]}",
        remedy="Correct the controller that commands them.",
    )
