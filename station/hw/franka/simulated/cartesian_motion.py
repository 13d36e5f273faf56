"""Turn Cartesian commands into joint motion, by an inverse kinematics with an elbow.

Source: Franka Control Interface documentation, Cartesian motion generators; differs:
see `station.hw.franka.simulated.cartesian_step`.
"""

from math import sqrt

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.simulated.arm_frames import MAX_EXTENSION
from station.hw.franka.simulated.cartesian_step import TWIST_SIZE, CartesianStep
from station.hw.franka.simulated.end_effector_state import EndEffectorState
from station.hw.franka.simulated.motion_checks import (
    START_ELBOW_TOLERANCE,
    START_ROTATION_TOLERANCE,
    START_TRANSLATION_TOLERANCE,
    elbow_errors,
    joint_motion_errors,
    twist_errors,
)
from station.memory.doubles import Doubles, put

Elbow = tuple[float, float]
"""Position of joint 3 [rad] and sign of joint 4."""


class CartesianMotion:
    """The Cartesian motion generator inside the arm. Control thread only.

    It looks closely at commands that the kernel's quick test does not let pass.

    Args:
        state: The arm's state; the commanded pose, twist and elbow are written.
        limits: The arm's limits.
        step: The arithmetic of a cycle, over the memory of the state.
        period: Duration of a cycle [s], > 0.
    """

    def __init__(
        self, state: RobotState, limits: ArmLimits, step: CartesianStep, period: float
    ) -> None:
        self._state = state
        self._limits = limits
        self._step = step
        self._period = period
        self._end_effector = EndEffectorState(state.doubles, CHAIN, MAX_EXTENSION)
        self._is_first = True

    def begin(self) -> None:
        """Start from the pose and the velocity of the desired joint motion."""
        self._end_effector.command_joint_motion()
        self._step.is_settled = False
        self._is_first = True

    def plan(self, elbow: Elbow | None) -> list[ArmError]:
        """Plan the cycle of the command that the kernel holds; return its errors.

        Args:
            elbow: The commanded elbow; None lets the arm choose.
        """
        errors = self._plan_end_effector() or self._plan_elbow(elbow)
        self._is_first = False
        return errors

    def extrapolate(self) -> None:
        """Continue with constant acceleration, because no command has arrived."""
        self._step.extrapolate()

    def solve(self) -> list[ArmError]:
        """Carry out what was planned; return the errors of the joints' step.

        The joints' next positions [rad] are in the `target` of the arm's cycle.
        """
        state, period, step = self._state, self._period, self._step
        step.accept()
        step.move_joints()
        q = [*step.target]
        dq = [(new - old) / period for new, old in zip(q, state.q_d, strict=True)]
        return joint_motion_errors(
            q,
            dq,
            last_dq=state.dq_d,
            last_ddq=state.ddq_d,
            limits=self._limits,
            period=period,
            from_pose=True,
        )

    def _plan_end_effector(self) -> list[ArmError]:
        state, step = self._state, self._step
        if not step.plan():
            name = "cartesian_position_motion_generator_invalid_frame"
            return [ArmError(name, "O_T_EE", 0.0, 0.0, "")]
        if self._is_first and step.size != TWIST_SIZE:
            errors = self._start_errors()
            if errors:
                return errors
        return twist_errors(
            [*step.next_twist],
            state.O_dP_EE_c,
            state.O_ddP_EE_c,
            self._limits,
            self._period,
        )

    def _start_errors(self) -> list[ArmError]:
        name = "cartesian_position_motion_generator_start_pose_invalid"
        found = []
        for part, where, bound, unit in (
            (slice(0, 3), "translation", START_TRANSLATION_TOLERANCE, "m"),
            (slice(3, 6), "rotation", START_ROTATION_TOLERANCE, "rad"),
        ):
            away = _norm(self._step.next_twist[part]) * self._period
            if away > bound:
                found.append(ArmError(name, where, away, bound, unit))
        return found

    def _plan_elbow(self, elbow: Elbow | None) -> list[ArmError]:
        state, period, step = self._state, self._period, self._step
        if elbow is None:
            step.rest_elbow()
            return []
        sign = state.elbow_c[1]
        if elbow[1] != sign:
            name = "cartesian_motion_generator_elbow_sign_inconsistent"
            return [ArmError(name, "elbow", elbow[1], sign, "")]
        away = elbow[0] - state.elbow_c[0]
        if self._is_first and abs(away) > START_ELBOW_TOLERANCE:
            name = "cartesian_motion_generator_start_elbow_invalid"
            return [ArmError(name, "elbow", abs(away), START_ELBOW_TOLERANCE, "rad")]
        rate = away / period
        acceleration = (rate - state.delbow_c[0]) / period
        jerk = (acceleration - state.ddelbow_c[0]) / period
        put(step.next_elbow, (elbow[0], rate, acceleration))
        return elbow_errors((rate, acceleration, jerk), self._limits)


def _norm(vector: Doubles) -> float:
    return sqrt(sum(value * value for value in vector))
