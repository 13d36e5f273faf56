"""Receive, check and follow the commands of a motion, and count the missing ones.

Source: Franka Control Interface documentation, what happens with lost packets.
"""

from collections import deque
from collections.abc import Sequence
from math import isfinite

from station.core.errors import InvalidCommandError
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS, MotionGeneratorMode
from station.hw.franka.simulated.cartesian_motion import (
    CartesianCommand,
    CartesianMotion,
)
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.motion_checks import (
    joint_motion_errors,
    start_position_errors,
    torque_errors,
)

_WINDOW = 100
_DOF = 7
_ZEROS = [0.0] * _DOF
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
        motion: The desired joint motion in it.
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.

    Attributes:
        torques: The client's torques [Nm], shape (7,).
        command: The last command of the client, of any kind.
        is_begun: Whether a command of this motion has been followed.
    """

    def __init__(
        self,
        state: RobotState,
        motion: DesiredMotion,
        limits: ArmLimits,
        period: float,
    ) -> None:
        self._state = state
        self._motion = motion
        self._limits = limits
        self._period = period
        self._cartesian = CartesianMotion(state, limits, period)
        self._generator = MotionGeneratorMode.NONE
        self.begin(MotionGeneratorMode.NONE)

    def begin(self, generator: MotionGeneratorMode) -> None:
        """Wait for the first command of a motion.

        Args:
            generator: The kind of motion that is commanded.
        """
        self._generator = generator
        self.torques: Sequence[float] = _ZEROS
        self.command: Sequence[float] = ()
        self.is_begun = False
        self._sent: Sequence[float] = _ZEROS
        self._target: Sequence[float] = _ZEROS
        self._cartesian_target = CartesianCommand(())
        self._is_fresh = False
        self._lost_in_a_row = 0
        self._cycle = 0
        self._losses: deque[int] = deque()
        self._cartesian.begin()

    def command_torques(self, tau: Sequence[float]) -> None:
        """Take torques [Nm], shape (7,), for the next cycle.

        Raises:
            InvalidCommandError: Not 7 finite numbers.
        """
        self.torques = self.command = _checked(tau, "joint torques", _DOF)
        self._is_fresh = True

    def command_joints(self, values: Sequence[float]) -> None:
        """Take positions [rad] or velocities [rad/s], shape (7,), for the next cycle.

        Raises:
            InvalidCommandError: Not 7 finite numbers.
        """
        self._target = self.command = _checked(values, "joint commands", _DOF)
        self._is_fresh = True

    def command_cartesian(
        self, values: Sequence[float], elbow: Sequence[float] | None, size: int
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
        self.command = _checked(values, "a Cartesian command", size)
        chosen = None
        if elbow is not None:
            if len(elbow) != 2 or not isfinite(elbow[0]) or abs(elbow[1]) != 1.0:
                raise InvalidCommandError(
                    f"An elbow of {elbow} is not possible.",
                    remedy="Give the position of joint 3 and a sign of +1 or -1.",
                )
            chosen = (elbow[0], elbow[1])
        self._cartesian_target = CartesianCommand(tuple(values), chosen)
        self._is_fresh = True

    def ignore(self) -> None:
        """Discard this cycle's command and slow down to rest."""
        self._is_fresh = False
        self._motion.hold()
        if self._generator in CARTESIAN_GENERATORS:
            self._cartesian.begin()

    def advance(self, *, torques_act: bool, is_lossy: bool) -> list[ArmError]:
        """Advance the desired motion by a cycle; return the errors.

        Args:
            torques_act: Whether the motors follow `torques`.
            is_lossy: Whether the command of this cycle is lost.
        """
        arrived = self._is_fresh and not is_lossy
        self._is_fresh = False
        if not arrived and not self.is_begun:
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
        self.is_begun = True
        return errors

    def _count(self, *, lost: bool) -> None:
        self._cycle += 1
        self._lost_in_a_row = self._lost_in_a_row + 1 if lost else 0
        losses = self._losses
        if lost:
            losses.append(self._cycle)
        if losses:
            while losses and losses[0] <= self._cycle - _WINDOW:
                losses.popleft()
            rate = 1.0 - len(losses) / _WINDOW
            self._state.control_command_success_rate = rate

    def _follow_torques(self, *, arrived: bool) -> list[ArmError]:
        if not arrived:
            self.torques = self._sent
            return []
        errors = torque_errors(
            self.torques, self._state.tau_J_d, self._sent, self._limits, self._period
        )
        self._sent = self.torques
        return errors

    def _follow_joints(self) -> list[ArmError]:
        state, period = self._state, self._period
        target = list(self._target)
        is_position = self._generator is MotionGeneratorMode.JOINT_POSITION
        if is_position:
            q = target
            dq = [(new - old) / period for new, old in zip(q, state.q_d, strict=True)]
            errors = [] if self.is_begun else start_position_errors(q, state.q_d)
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
            self._motion.follow_positions(q)
        elif not errors:
            self._motion.follow_velocities(dq)
        return errors

    def _follow_cartesian(self, *, arrived: bool) -> list[ArmError]:
        cartesian = self._cartesian
        if arrived:
            errors = cartesian.receive(self._cartesian_target)
            if errors:
                return errors
        else:
            cartesian.extrapolate()
        q, errors = cartesian.solve()
        if not errors:
            self._motion.follow_positions(q)
        return errors


def _checked(values: Sequence[float], what: str, size: int) -> list[float]:
    if len(values) != size or not isfinite(sum(values)):
        raise InvalidCommandError(
            f"{what} must be {size} finite numbers, not {values}",
            remedy="Correct the controller that commands them.",
        )
    return list(values)
