"""Vectors of three numbers through the limits of `pose_rates`."""

from collections.abc import Sequence

from station.hw.franka.arm.arm_limits import MotionLimits
from station.hw.franka.commands.pose_rates import limit_vector
from station.memory.doubles import doubles

PERIOD = 0.001


def limited(
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
