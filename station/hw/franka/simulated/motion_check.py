"""Check a commanded motion as the arm receives it.

Derivatives are backward differences over one cycle, from the last accepted values.

Source: Franka Control Interface documentation, Robot and interface specifications,
necessary conditions; libfranka@0.15.0 include/franka/errors.h, for the position limits
that an FR3 never reports.
"""

from math import inf

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.velocity_curves import VelocityCurves
from station.hw.franka.simulated.violations import (
    JOINT_POSITION,
    JOINT_START,
    TORQUE_RATE,
    TRANSLATION_ACCELERATION,
    TRANSLATION_JERK,
    TRANSLATION_VELOCITY,
    Violations,
)
from station.memory.doubles import Doubles, Storage, own, own_zeros, put
from station.memory.functions import square_root

START_POSITION_TOLERANCE = 0.01
"""Largest distance of a first joint position from q_d [rad]; not published."""
# 1 + the relative rounding error of a third difference over 1 ms of some rad.
_ROUNDING = 1.0 + 1e-4
# Half a step of single precision from 4 to 8 rad, and from 64 to 128 Nm. A client of
# version 10 gets the state in single precision: where its rate limiter stays at a
# limit, its command is that far from the one that continues the arm's motion.
_UNSEEN = 2.0**-22
_UNSEEN_TORQUE = 2.0**-18
# Rounding error allowed for a command at a position limit [rad].
_AT_LIMIT = 1e-6
# Rounding error allowed for a velocity, a difference over 1 ms of positions [rad/s].
_AT_VELOCITY_LIMIT = 1e-9


class MotionCheck:
    """Compares the commands of an arm with its limits.

    Every check returns the number of violations in this cycle.

    Args:
        memory: State and commands of the joints.
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.

    Attributes:
        violations: Violations since the last `clear`.
    """

    def __init__(self, memory: JointMemory, limits: ArmLimits, period: float) -> None:
        self.memory = memory
        self.size = memory.size
        self.limits = limits
        margins = [-_AT_VELOCITY_LIMIT] * memory.size
        self.curves = VelocityCurves(limits.velocity, limits.curves, margins)
        self.before = own_zeros(memory.size)
        # Limits that depend on the position make the velocity 0 before the limit.
        room = inf if limits.curves else _AT_LIMIT
        self.lower = own([value - room for value in limits.lower])
        self.upper = own([value + room for value in limits.upper])
        room = _AT_VELOCITY_LIMIT
        self.slowest = own([-value - room for value in limits.velocity])
        self.fastest = own([value + room for value in limits.velocity])
        self.acceleration = own_zeros(memory.size)
        self.jerk = own_zeros(memory.size)
        self.translation = own(limits.translation.bounds())
        self.rotation = own(limits.rotation.bounds())
        self.elbow = own(limits.elbow.bounds())
        self.period = period
        self.reached = own_zeros(memory.size)
        self.violations = Violations()
        self.set_precision(is_single=False)

    def set_precision(self, *, is_single: bool) -> None:
        """Set the precision in which the commander sees the state; double at first."""
        limits, period = self.limits, self.period
        self.unseen = unseen = _UNSEEN if is_single else 0.0
        rate, jerk = unseen / period**2, unseen / period**3
        put(self.acceleration, [a * _ROUNDING + rate for a in limits.acceleration])
        put(self.jerk, [value * _ROUNDING + jerk for value in limits.jerk])
        # With room for the rounding of a difference.
        self.torque_step = limits.torque_rate * period * (1.0 + 1e-9)
        if is_single:
            self.torque_step += _UNSEEN_TORQUE

    def check_start(self) -> int:
        """Compare the first positions of a motion, in `target`, with `q_d`."""
        q, q_d = self.memory.target, self.memory.q_d
        for i in range(self.size):
            away = abs(q[i] - q_d[i])
            if away > START_POSITION_TOLERANCE:
                self.violations.add(JOINT_START, i, away, START_POSITION_TOLERANCE)
        return self.violations.count

    def check_target(self, q: Storage) -> int:
        """Compare positions at which a motion is to end with the limits.

        Args:
            q: The positions [rad], shape (7,).
        """
        limits = self.limits
        for i in range(self.size):
            low, high = limits.velocity_range(i, q[i])
            if q[i] > limits.upper[i] or high == 0.0:
                self.violations.add(JOINT_POSITION, i, q[i], limits.upper[i])
            elif q[i] < limits.lower[i] or low == 0.0:
                self.violations.add(JOINT_POSITION, i, q[i], limits.lower[i])
        return self.violations.count

    def check_positions(self, code: int) -> int:
        """Compare the positions in `target` with the limits.

        Args:
            code: `JOINT_POSITION`, or `SOLVED_POSITION` if they were computed from a
                Cartesian command.
        """
        memory, period = self.memory, self.period
        q, dq, q_d = memory.target, memory.target_dq, memory.q_d
        for i in range(self.size):
            dq[i] = (q[i] - q_d[i]) / period
        return self.check_joints(q, dq, code)

    def check_velocities(self) -> int:
        """Compare the velocities in `target` with the limits."""
        memory, period, q = self.memory, self.period, self.reached
        dq, q_d = memory.target, memory.q_d
        for i in range(self.size):
            q[i] = q_d[i] + dq[i] * period
        return self.check_joints(q, dq, JOINT_POSITION)

    def check_joints(self, q: Storage, dq: Storage, code: int) -> int:
        """Compare a step of a joint motion with the limits.

        Args:
            q: Next positions [rad], shape (7,).
            dq: Velocities that lead there [rad/s], shape (7,).
            code: See `check_positions`; the codes of the rates follow this code.
        """
        last_dq, last_ddq = self.memory.dq_d, self.memory.ddq_d
        lower, upper = self.lower, self.upper
        slowest, fastest = self.slowest, self.fastest
        accelerations, jerks, period = self.acceleration, self.jerk, self.period
        violations = self.violations
        if self.curves.size:
            before = self.before
            for i in range(self.size):
                before[i] = q[i] - dq[i] * period
            self.curves.put(before, slowest, fastest)
        for i in range(self.size):
            position, velocity = q[i], dq[i]
            acceleration = (velocity - last_dq[i]) / period
            jerk = (acceleration - last_ddq[i]) / period
            # A joint beyond its limit may stay or come back; otherwise it could never
            # return.
            if position > upper[i] and velocity > 0.0:
                violations.add(code, i, position, self.limits.upper[i])
            elif position < lower[i] and velocity < 0.0:
                violations.add(code, i, position, self.limits.lower[i])
            if not slowest[i] <= velocity <= fastest[i]:
                bounds = self.limits.velocity_range(i, position - velocity * period)
                violations.add(code + 1, i, velocity, bounds[velocity > 0.0])
            most = accelerations[i]
            if not -most <= acceleration <= most:
                bound = self.limits.acceleration[i]
                violations.add(code + 2, i, acceleration, bound)
            most = jerks[i]
            if not -most <= jerk <= most:
                violations.add(code + 3, i, jerk, self.limits.jerk[i])
        return violations.count

    def check_torques(self) -> int:
        """Compare the commanded torques with the limit of their rate.

        They may continue the torques of the motors, which saturate, or the torques that
        were commanded before.
        """
        memory, largest = self.memory, self.torque_step
        lowest = -largest
        tau, last, sent = memory.torques, memory.tau_J_d, memory.sent
        for i in range(self.size):
            # Without `abs`, whose call costs time in Python.
            if not lowest <= tau[i] - last[i] <= largest:
                # `tau_J_d` is cut off at the motor's limit: a client that keeps asking
                # for more makes no step.
                step = min(abs(tau[i] - last[i]), abs(tau[i] - sent[i]))
                if step > largest:
                    rate = self.limits.torque_rate
                    self.violations.add(TORQUE_RATE, i, step / self.period, rate)
        return self.violations.count

    def check_twist(self, twist: Doubles, last: Doubles, last_rate: Doubles) -> int:
        """Compare the next twist of the end effector with the limits, by its norms.

        Args:
            twist: Linear [m/s], then angular velocity [rad/s], shape (6,).
            last: Twist of the step before, shape (6,).
            last_rate: Rate of the twist in the step before, shape (6,).
        """
        self.check_part(0, twist, last, last_rate, self.translation)
        self.check_part(3, twist, last, last_rate, self.rotation)
        return self.violations.count

    def check_part(
        self,
        first: int,
        twist: Doubles,
        last: Doubles,
        last_rate: Doubles,
        bounds: Storage,
    ) -> None:
        """Compare one half of a twist with its limits; see `check_twist`.

        Args:
            first: Index of the first number of the half.
            twist: The twist, shape (6,).
            last: Twist of the step before, shape (6,).
            last_rate: Rate of the twist in the step before, shape (6,).
            bounds: Largest norms of velocity, acceleration and jerk.
        """
        period = self.period
        speed = acceleration = jerk = 0.0
        for i in range(first, first + 3):
            velocity = twist[i]
            rate = (velocity - last[i]) / period
            change = (rate - last_rate[i]) / period
            speed += velocity * velocity
            acceleration += rate * rate
            jerk += change * change
        speed, acceleration = square_root(speed), square_root(acceleration)
        self.check_bounds(first, speed, acceleration, square_root(jerk), bounds)

    def check_elbow(self, velocity: float, acceleration: float, jerk: float) -> int:
        """Compare the next step of the elbow with its limits.

        Args:
            velocity: Velocity of joint 3 [rad/s].
            acceleration: Acceleration of joint 3 [rad/s^2].
            jerk: Jerk of joint 3 [rad/s^3].
        """
        self.check_bounds(6, velocity, acceleration, jerk, self.elbow)
        return self.violations.count

    def check_bounds(
        self,
        first: int,
        velocity: float,
        acceleration: float,
        jerk: float,
        bounds: Storage,
    ) -> None:
        """Compare the translation, the rotation or the elbow with its limits.

        Args:
            first: Offset of its codes from those of the translation.
            velocity: Velocity [m/s or rad/s].
            acceleration: Acceleration [m/s^2 or rad/s^2].
            jerk: Jerk [m/s^3 or rad/s^3].
            bounds: Limits of velocity, acceleration and jerk.
        """
        violations, room = self.violations, self.unseen / self.period / self.period
        if abs(velocity) > bounds[0] * _ROUNDING:
            violations.add(TRANSLATION_VELOCITY + first, 0, velocity, bounds[0])
        if abs(acceleration) > bounds[1] * _ROUNDING + room:
            code = TRANSLATION_ACCELERATION + first
            violations.add(code, 0, acceleration, bounds[1])
        if abs(jerk) > bounds[2] * _ROUNDING + room / self.period:
            violations.add(TRANSLATION_JERK + first, 0, jerk, bounds[2])
