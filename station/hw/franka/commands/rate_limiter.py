"""Low-pass filter and rate limits of one joint's commands, as libfranka has them.

Pure functions of plain floats. `period` is libfranka's fixed cycle of 1 ms.

Source: libfranka@0.9.2 src/lowpass_filter.cpp, lowpassFilter; src/rate_limiting.cpp,
limitRate; include/franka/rate_limiting.h, the limits of the Panda; libfranka@0.15.0,
the same files, for the FR3.
"""

from dataclasses import dataclass
from math import pi

from station.core.franka.command_rates import limited
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, ArmLimits, MotionLimits

PERIOD = 0.001
"""Cycle of the arm [s]."""
MAX_CUTOFF_FREQUENCY = 1000.0
"""Cutoff frequency from which on the low-pass filter is off [Hz]."""
MARGIN = 1e-3
"""Margin subtracted from every limit, in the unit of the limit."""


VelocityRange = tuple[float, float]
"""Lowest velocity [rad/s], <= 0, and highest velocity [rad/s], >= 0."""


@dataclass(frozen=True, slots=True)
class RateLimits:
    """Limits of one joint's command.

    Attributes:
        velocity: [rad/s], > 0.
        acceleration: [rad/s^2], > 0.
        jerk: [rad/s^3], > 0.
        torque_rate: [Nm/s], > 0.
    """

    velocity: float
    acceleration: float
    jerk: float
    torque_rate: float


def rate_limits_of(limits: ArmLimits) -> tuple[RateLimits, ...]:
    """Return the limits of an arm's joints, with libfranka's margins, shape (7,).

    Args:
        limits: The arm's own limits.
    """
    result = []
    for velocity, acceleration, jerk in zip(
        limits.velocity, limits.acceleration, limits.jerk, strict=True
    ):
        motion = with_margins(
            MotionLimits(velocity, acceleration, jerk), limits.tolerated_losses
        )
        result.append(
            RateLimits(
                motion.velocity,
                motion.acceleration,
                motion.jerk,
                limits.torque_rate - MARGIN,
            )
        )
    return tuple(result)


def with_margins(limits: MotionLimits, tolerated_losses: int) -> MotionLimits:
    """Return limits reduced by libfranka's margins.

    Args:
        limits: The arm's own limits of a motion.
        tolerated_losses: Lost packets, during which the arm goes on with constant
            acceleration, for which the velocity leaves room.
    """
    acceleration = limits.acceleration - MARGIN
    reserve = tolerated_losses * PERIOD * acceleration
    return MotionLimits(
        limits.velocity - MARGIN - reserve, acceleration, limits.jerk - MARGIN
    )


def velocity_range_of(limits: ArmLimits, joint: int, q_d: float) -> VelocityRange:
    """Return the velocities that the limiter allows a joint at a position.

    Limits that depend on the position have no reserve for lost packets.

    Args:
        limits: The arm's own limits.
        joint: Index of the joint, 0 to 6.
        q_d: Its desired position [rad].

    Source:
        libfranka@0.15.0 include/franka/rate_limiting.h,
        computeUpperLimitsJointVelocity, computeLowerLimitsJointVelocity; differs: the
        margin does not turn a range of 0 inside out.
    """
    lowest, highest = limits.velocity_range(joint, q_d)
    return min(0.0, lowest + MARGIN), max(0.0, highest - MARGIN)


PANDA_RATE_LIMITS = rate_limits_of(PANDA_LIMITS)
"""The Panda's limits, joints 1 to 7."""


def low_pass_gain(cutoff_frequency: float) -> float:
    """Return the share of a new command in the low-pass, 0 to 1; 1 is off.

    Args:
        cutoff_frequency: [Hz], > 0; `MAX_CUTOFF_FREQUENCY` and above is off.
    """
    if cutoff_frequency >= MAX_CUTOFF_FREQUENCY:
        return 1.0
    return PERIOD / (PERIOD + 1.0 / (2.0 * pi * cutoff_frequency))


def limit_velocity(
    velocity: float,
    last_velocity: float,
    last_acceleration: float,
    limits: RateLimits,
    velocity_range: VelocityRange | None = None,
) -> float:
    """Return the velocity nearest to a command that all limits allow.

    Close to the velocity limit the acceleration is limited further, so that it can
    reach zero at the limit without exceeding the jerk limit.

    Args:
        velocity: The new command [rad/s].
        last_velocity: The last command [rad/s].
        last_acceleration: Its acceleration [rad/s^2].
        limits: The joint's limits.
        velocity_range: What is allowed at the present position; None: what `limits`
            allow anywhere.
    """
    lowest_velocity, highest_velocity = velocity_range or (
        -limits.velocity,
        limits.velocity,
    )
    return limited(
        velocity,
        last_velocity,
        last_acceleration,
        limits.acceleration,
        limits.jerk,
        lowest_velocity,
        highest_velocity,
        PERIOD,
    )


def limit_position(
    position: float,
    last_position: float,
    last_velocity: float,
    last_acceleration: float,
    limits: RateLimits,
    velocity_range: VelocityRange | None = None,
) -> float:
    """Return the position nearest to a command that all limits allow.

    It does not look ahead: after a step it arrives with full speed and overshoots.

    Args:
        position: The new command [rad].
        last_position: The last command [rad].
        last_velocity: Its velocity [rad/s].
        last_acceleration: Its acceleration [rad/s^2].
        limits: The joint's limits.
        velocity_range: As for `limit_velocity`.
    """
    velocity = (position - last_position) / PERIOD
    velocity = limit_velocity(
        velocity, last_velocity, last_acceleration, limits, velocity_range
    )
    return last_position + velocity * PERIOD
