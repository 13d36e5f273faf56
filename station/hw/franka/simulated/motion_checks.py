"""Check a commanded motion as the arm receives it. Pure functions.

Derivatives are backward differences over one cycle, from the values accepted last.

Source: Franka Control Interface documentation, Robot and interface specifications,
necessary conditions; libfranka@0.15.0 include/franka/errors.h, the position limits that
an FR3 never reports.
"""

from collections.abc import Sequence
from math import sqrt

from station.core.franka.franka_errors import ArmError
from station.hw.franka.arm.arm_limits import ArmLimits, MotionLimits

START_POSITION_TOLERANCE = 0.01
"""Largest distance of a first joint position from q_d [rad]; not published."""
START_TRANSLATION_TOLERANCE = 0.005
"""Largest distance of a first pose from O_T_EE_d [m]; not published."""
START_ROTATION_TOLERANCE = 0.01
"""Largest angle between a first pose and O_T_EE_d [rad]; not published."""
START_ELBOW_TOLERANCE = 0.01
"""Largest distance of a first elbow position from elbow_d [rad]; not published."""
# Relative rounding error of a third difference over 1 ms of positions of a few rad.
_ROUNDING = 1e-4
# Rounding error allowed for a command at a position limit [rad].
_AT_LIMIT = 1e-6
# Rounding error allowed for a velocity, a difference over 1 ms of positions [rad/s].
_AT_VELOCITY_LIMIT = 1e-9
_JOINT_ERRORS = (
    "joint_motion_generator_position_limits_violation",
    "joint_motion_generator_velocity_limits_violation",
    "joint_motion_generator_velocity_discontinuity",
    "joint_motion_generator_acceleration_discontinuity",
)
_IK_ERRORS = (
    "cartesian_motion_generator_joint_position_limits_violation",
    "cartesian_motion_generator_joint_velocity_limits_violation",
    "cartesian_motion_generator_joint_velocity_discontinuity",
    "cartesian_motion_generator_joint_acceleration_discontinuity",
)


def joint_motion_errors(
    q: Sequence[float],
    dq: Sequence[float],
    *,
    last_dq: Sequence[float],
    last_ddq: Sequence[float],
    limits: ArmLimits,
    period: float,
    from_pose: bool = False,
) -> list[ArmError]:
    """Return the errors of the next step of a joint motion.

    Args:
        q: Next positions [rad], shape (7,).
        dq: Velocities that lead there [rad/s], shape (7,).
        last_dq: Velocities of the step before [rad/s], shape (7,).
        last_ddq: Accelerations of the step before [rad/s^2], shape (7,).
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.
        from_pose: Whether the motion was computed from a Cartesian command.
    """
    if not limits.curves and _is_well_inside(q, dq, last_dq, last_ddq, limits, period):
        return []
    found: list[ArmError] = []
    names = _IK_ERRORS if from_pose else _JOINT_ERRORS
    for i, velocity in enumerate(dq):
        acceleration = (velocity - last_dq[i]) / period
        jerk = (acceleration - last_ddq[i]) / period
        lowest, highest = -limits.velocity[i], limits.velocity[i]
        if limits.curves:
            lowest, highest = limits.velocity_range(i, q[i] - velocity * period)
        is_too_fast = not (
            lowest - _AT_VELOCITY_LIMIT <= velocity <= highest + _AT_VELOCITY_LIMIT
        )
        # A joint beyond its limit may stay or come back, or it could never return.
        # Limits that depend on the position bring the velocity to 0 before the limit.
        goes_out = not limits.curves and (
            (q[i] > limits.upper[i] + _AT_LIMIT and velocity > 0.0)
            or (q[i] < limits.lower[i] - _AT_LIMIT and velocity < 0.0)
        )
        if (
            not goes_out
            and not is_too_fast
            and abs(acceleration) <= limits.acceleration[i] * (1.0 + _ROUNDING)
            and abs(jerk) <= limits.jerk[i] * (1.0 + _ROUNDING)
        ):
            continue
        bound = limits.upper[i] if q[i] > limits.upper[i] else limits.lower[i]
        speed = highest if velocity > 0.0 else lowest
        if goes_out:
            found.append(ArmError(names[0], _joint(i), q[i], bound, "rad"))
        if is_too_fast:
            found.append(ArmError(names[1], _joint(i), velocity, speed, "rad/s"))
        if abs(acceleration) > limits.acceleration[i] * (1.0 + _ROUNDING):
            allowed = limits.acceleration[i]
            found.append(
                ArmError(names[2], _joint(i), acceleration, allowed, "rad/s^2")
            )
        if abs(jerk) > limits.jerk[i] * (1.0 + _ROUNDING):
            found.append(ArmError(names[3], _joint(i), jerk, limits.jerk[i], "rad/s^3"))
    return sorted(found, key=lambda error: names.index(error.name))


def _is_well_inside(
    q: Sequence[float],
    dq: Sequence[float],
    last_dq: Sequence[float],
    last_ddq: Sequence[float],
    limits: ArmLimits,
    period: float,
) -> bool:
    """Return whether a joint motion is certainly free of errors, by a quick test."""
    for position, velocity, last, last_rate, low, high, fastest, rate, jerk in zip(
        q,
        dq,
        last_dq,
        last_ddq,
        limits.lower,
        limits.upper,
        limits.velocity,
        limits.acceleration,
        limits.jerk,
        strict=True,
    ):
        acceleration = (velocity - last) / period
        if not (
            low <= position <= high
            and -fastest <= velocity <= fastest
            and -rate <= acceleration <= rate
            and -jerk <= (acceleration - last_rate) / period <= jerk
        ):
            return False
    return True


def start_position_errors(q: Sequence[float], q_d: Sequence[float]) -> list[ArmError]:
    """Return the errors of the first positions of a motion.

    Args:
        q: First positions [rad], shape (7,).
        q_d: Desired positions before the motion [rad], shape (7,).
    """
    name = "joint_position_motion_generator_start_pose_invalid"
    return [
        ArmError(name, _joint(i), abs(a - b), START_POSITION_TOLERANCE, "rad")
        for i, (a, b) in enumerate(zip(q, q_d, strict=True))
        if abs(a - b) > START_POSITION_TOLERANCE
    ]


def torque_errors(
    tau: Sequence[float],
    last: Sequence[float],
    sent: Sequence[float],
    limits: ArmLimits,
    period: float,
) -> list[ArmError]:
    """Return the errors of the next torques.

    Args:
        tau: Commanded torques [Nm], shape (7,).
        last: Last torques of the motors, after saturation [Nm], shape (7,).
        sent: Last commanded torques [Nm], shape (7,).
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.
    """
    largest = limits.torque_rate * period * (1.0 + 1e-9)
    for value, before in zip(tau, last, strict=True):
        if not -largest <= value - before <= largest:
            break
    else:
        return []
    found = []
    for i, value in enumerate(tau):
        step = min(abs(value - last[i]), abs(value - sent[i]))
        if step > largest:
            rate = step / period
            name = "controller_torque_discontinuity"
            found.append(ArmError(name, _joint(i), rate, limits.torque_rate, "Nm/s"))
    return found


def twist_errors(
    twist: Sequence[float],
    last: Sequence[float],
    last_rate: Sequence[float],
    limits: ArmLimits,
    period: float,
) -> list[ArmError]:
    """Return the errors of the next twist of the end effector.

    Args:
        twist: Linear [m/s], then angular velocity [rad/s], shape (6,).
        last: Twist of the step before, shape (6,).
        last_rate: Rate of the twist in the step before, shape (6,).
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.
    """
    rate = [(new - old) / period for new, old in zip(twist, last, strict=True)]
    jerk = [(new - old) / period for new, old in zip(rate, last_rate, strict=True)]
    found: list[ArmError] = []
    for part, where, unit, bounds in (
        (slice(0, 3), "translation", "m", limits.translation),
        (slice(3, 6), "rotation", "rad", limits.rotation),
    ):
        found += _bound_errors(
            (_norm(twist[part]), _norm(rate[part]), _norm(jerk[part])),
            where,
            unit,
            bounds,
        )
    return found


def elbow_errors(
    rates: tuple[float, float, float], limits: ArmLimits
) -> list[ArmError]:
    """Return the errors of the next step of the elbow.

    Args:
        rates: Velocity [rad/s], acceleration [rad/s^2] and jerk [rad/s^3].
        limits: The arm's limits.
    """
    name = "cartesian_motion_generator_elbow_limit_violation"
    bounds = (limits.elbow.velocity, limits.elbow.acceleration, limits.elbow.jerk)
    units = ("rad/s", "rad/s^2", "rad/s^3")
    return [
        ArmError(name, "elbow", value, bound, unit)
        for value, bound, unit in zip(rates, bounds, units, strict=True)
        if abs(value) > bound * (1.0 + _ROUNDING)
    ]


def _bound_errors(
    values: tuple[float, float, float], where: str, unit: str, bounds: MotionLimits
) -> list[ArmError]:
    return [
        ArmError(
            f"cartesian_motion_generator_{what}", where, value, bound, f"{unit}{per}"
        )
        for value, bound, what, per in zip(
            values,
            (bounds.velocity, bounds.acceleration, bounds.jerk),
            (
                "velocity_limits_violation",
                "velocity_discontinuity",
                "acceleration_discontinuity",
            ),
            ("/s", "/s^2", "/s^3"),
            strict=True,
        )
        if value > bound * (1.0 + _ROUNDING)
    ]


def _norm(vector: Sequence[float]) -> float:
    return sqrt(sum(value * value for value in vector))


def _joint(index: int) -> str:
    return f"joint{index + 1}"
