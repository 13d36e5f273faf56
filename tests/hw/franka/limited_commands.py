"""Single commands through the limits of an arm, as plain functions of floats."""

from collections.abc import Sequence

from station.core.numerics.command_rates import limited
from station.hw.franka.arm.arm_limits import MotionLimits
from station.hw.franka.commands.cartesian_sender import limit_vector
from station.hw.franka.commands.rate_limiter import PERIOD
from station.memory.doubles import doubles


def limit_twist(
    velocity: Sequence[float],
    last_velocity: Sequence[float],
    last_acceleration: Sequence[float],
    limits: MotionLimits,
) -> list[float]:
    """Return the velocity nearest to a command that all limits allow, shape (3,)."""
    result = doubles(velocity)
    limit_vector(
        result,
        0,
        doubles(last_velocity),
        doubles(last_acceleration),
        doubles(limits.bounds()),
        1.0,
        PERIOD,
    )
    return [*result]


def limit_velocity(
    velocity: float,
    last_velocity: float,
    last_acceleration: float,
    limits: MotionLimits,
    velocity_range: tuple[float, float] | None = None,
) -> float:
    """Return the velocity of a joint nearest to a command that all limits allow."""
    lowest, highest = velocity_range or (-limits.velocity, limits.velocity)
    return limited(
        velocity,
        last_velocity,
        last_acceleration,
        limits.acceleration,
        limits.jerk,
        lowest,
        highest,
        PERIOD,
    )


def limit_position(
    position: float,
    last_position: float,
    last_velocity: float,
    last_acceleration: float,
    limits: MotionLimits,
    velocity_range: tuple[float, float] | None = None,
) -> float:
    """Return the position of a joint nearest to a command that all limits allow."""
    velocity = limit_velocity(
        (position - last_position) / PERIOD,
        last_velocity,
        last_acceleration,
        limits,
        velocity_range,
    )
    return last_position + velocity * PERIOD
