"""Turn Cartesian commands into joint motion, by an inverse kinematics with an elbow.

Source: Franka Control Interface documentation, Cartesian motion generators; differs:
the inverse kinematics of the arm is not public; here it is a Newton step per cycle with
the position of joint 3 as the seventh coordinate, damped near singular poses.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.rigid_motion import displace, twist_between
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import CHAIN, DOF
from station.hw.franka.arm.transform_check import transform_problem
from station.hw.franka.commands.rate_limiter import RateLimits, limit_velocity
from station.hw.franka.simulated.arm_frames import MAX_EXTENSION
from station.hw.franka.simulated.motion_checks import (
    START_ELBOW_TOLERANCE,
    START_ROTATION_TOLERANCE,
    START_TRANSLATION_TOLERANCE,
    elbow_errors,
    joint_motion_errors,
    twist_errors,
)
from station.kernel.doubles import zeros
from station.kernel.end_effector_state import EndEffectorState
from station.kernel.inverse_kinematics import InverseKinematics


@dataclass(frozen=True, slots=True)
class CartesianCommand:
    """One Cartesian command of a client.

    Attributes:
        values: Pose O_T_EE, 16 numbers, or twist O_dP_EE, 6 numbers.
        elbow: Position of joint 3 [rad] and sign of joint 4; None lets the arm choose.
    """

    values: tuple[float, ...]
    elbow: tuple[float, float] | None = None


class CartesianMotion:
    """The Cartesian motion generator inside the arm. Control thread only.

    Args:
        state: The arm's state; the commanded pose, twist and elbow are written.
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.
    """

    def __init__(self, state: RobotState, limits: ArmLimits, period: float) -> None:
        self._state = state
        self._limits = limits
        self._period = period
        elbow = limits.elbow
        self._elbow_limits = RateLimits(
            elbow.velocity, elbow.acceleration, elbow.jerk, limits.torque_rate
        )
        self._end_effector = EndEffectorState(state.doubles, CHAIN, MAX_EXTENSION)
        self._q, self._step = state.doubles("q_d"), zeros(DOF)
        self._kinematics = InverseKinematics(
            CHAIN,
            self._q,
            state.doubles("F_T_EE"),
            state.doubles("O_T_EE_c"),
            self._step,
        )
        self._is_first = True
        self._elbow = 0.0
        self._next_pose: list[float] = []
        self._next_twist: list[float] = []
        self._next_elbow = (0.0, 0.0, 0.0)

    def begin(self) -> None:
        """Start from the pose and the velocity of the desired joint motion."""
        state = self._state
        self._end_effector.command_joint_motion()
        self._elbow = state.q_d[2]
        self._is_first = True

    def receive(self, command: CartesianCommand) -> list[ArmError]:
        """Take a command for the next cycle; return its errors."""
        errors = self._plan(command)
        if not errors:
            errors = self._plan_elbow(command.elbow)
        self._is_first = False
        return errors

    def extrapolate(self) -> None:
        """Continue with constant acceleration, because no command has arrived."""
        state, period = self._state, self._period
        self._next_twist = [
            v + a * period
            for v, a in zip(state.O_dP_EE_c, state.O_ddP_EE_c, strict=True)
        ]
        self._next_pose = _moved(state.O_T_EE_c, self._next_twist, period)
        rate = state.delbow_c[0] + state.ddelbow_c[0] * period
        self._next_elbow = (self._elbow + rate * period, rate, state.ddelbow_c[0])

    def solve(self) -> tuple[list[float], list[ArmError]]:
        """Accept the command; return the next q_d [rad] and the errors of that step."""
        self._accept()
        q = self._inverse_kinematics()
        state, period = self._state, self._period
        dq = [(new - old) / period for new, old in zip(q, state.q_d, strict=True)]
        return q, joint_motion_errors(
            q,
            dq,
            last_dq=state.dq_d,
            last_ddq=state.ddq_d,
            limits=self._limits,
            period=period,
            from_pose=True,
        )

    def _plan(self, command: CartesianCommand) -> list[ArmError]:
        state, period = self._state, self._period
        values = list(command.values)
        if len(values) == 6:
            self._next_twist = values
            self._next_pose = _moved(state.O_T_EE_c, values, period)
        else:
            if transform_problem(values) is not None:
                name = "cartesian_position_motion_generator_invalid_frame"
                return [ArmError(name, "O_T_EE", 0.0, 0.0, "")]
            self._next_pose = values
            self._next_twist = twist_between(state.O_T_EE_c, values, period)
            if self._is_first:
                errors = self._start_errors()
                if errors:
                    return errors
        return twist_errors(
            self._next_twist, state.O_dP_EE_c, state.O_ddP_EE_c, self._limits, period
        )

    def _start_errors(self) -> list[ArmError]:
        name = "cartesian_position_motion_generator_start_pose_invalid"
        found = []
        for part, where, bound, unit in (
            (slice(0, 3), "translation", START_TRANSLATION_TOLERANCE, "m"),
            (slice(3, 6), "rotation", START_ROTATION_TOLERANCE, "rad"),
        ):
            away = float(np.linalg.norm(self._next_twist[part])) * self._period
            if away > bound:
                found.append(ArmError(name, where, away, bound, unit))
        return found

    def _plan_elbow(self, elbow: tuple[float, float] | None) -> list[ArmError]:
        state, period = self._state, self._period
        if elbow is None:
            # The arm's own choice: joint 3 comes to rest.
            speed, last = state.delbow_c[0], state.ddelbow_c[0]
            rate = limit_velocity(0.0, speed, last, self._elbow_limits)
            self._next_elbow = (
                self._elbow + rate * period,
                rate,
                (rate - speed) / period,
            )
            return []
        sign = state.elbow_c[1]
        if elbow[1] != sign:
            name = "cartesian_motion_generator_elbow_sign_inconsistent"
            return [ArmError(name, "elbow", elbow[1], sign, "")]
        away = elbow[0] - self._elbow
        if self._is_first and abs(away) > START_ELBOW_TOLERANCE:
            name = "cartesian_motion_generator_start_elbow_invalid"
            return [ArmError(name, "elbow", abs(away), START_ELBOW_TOLERANCE, "rad")]
        rate = away / period
        acceleration = (rate - state.delbow_c[0]) / period
        jerk = (acceleration - state.ddelbow_c[0]) / period
        self._next_elbow = (elbow[0], rate, acceleration)
        return elbow_errors((rate, acceleration, jerk), self._limits)

    def _accept(self) -> None:
        state, period = self._state, self._period
        state.O_ddP_EE_c = [
            (new - old) / period
            for new, old in zip(self._next_twist, state.O_dP_EE_c, strict=True)
        ]
        state.O_dP_EE_c = self._next_twist
        state.O_T_EE_c = self._next_pose
        self._elbow, rate, acceleration = self._next_elbow
        state.doubles("elbow_c")[0] = self._elbow
        state.doubles("delbow_c")[0] = rate
        state.doubles("ddelbow_c")[0] = acceleration

    def _inverse_kinematics(self) -> list[float]:
        self._kinematics.advance(self._elbow)
        return [a + b for a, b in zip(self._q, self._step, strict=True)]


def _moved(pose: Sequence[float], twist: Sequence[float], period: float) -> list[float]:
    return displace(
        pose, [v * period for v in twist[:3]], [w * period for w in twist[3:]]
    )
