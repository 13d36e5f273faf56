"""Low-pass and rate limits of one joint, against closed forms and their own bounds."""

import math
import random

import pytest

from station.core.franka.command_rates import filtered
from station.hw.franka.commands.rate_limiter import (
    PANDA_RATE_LIMITS,
    PERIOD,
    RateLimits,
    limit_position,
    limit_velocity,
    low_pass_gain,
)

LIMITS = PANDA_RATE_LIMITS[0]


def test_limits_of_the_panda_carry_libfrankas_margins() -> None:
    velocities = [2.12900, 2.15150, 2.14400, 2.13650, 2.56400, 2.54900, 2.54900]
    # Published to 5 digits; the margins' products add 3e-6.
    assert [limits.velocity for limits in PANDA_RATE_LIMITS] == pytest.approx(
        velocities, abs=5e-6
    )
    assert LIMITS.acceleration == pytest.approx(14.999)
    assert LIMITS.jerk == pytest.approx(7499.999)
    assert LIMITS.torque_rate == pytest.approx(999.999)


def test_low_pass_of_100_hz_has_the_published_gain() -> None:
    assert low_pass_gain(100.0) == pytest.approx(0.3859, abs=5e-5)


def test_low_pass_settles_like_a_first_order_filter() -> None:
    value = 0.0
    for _ in range(100):
        value = filtered(1.0, value, low_pass_gain(10.0))
    # Backward Euler of tau = 1 / (2 pi f): (1 + dt / tau)^-n.
    assert value == pytest.approx(1.0 - (1.0 + PERIOD * 20.0 * math.pi) ** -100)


@pytest.mark.parametrize("cutoff", [1000.0, 5000.0])
def test_low_pass_is_off_from_1000_hz_on(cutoff: float) -> None:
    assert low_pass_gain(cutoff) == 1.0


def test_velocity_within_the_limits_passes() -> None:
    assert limit_velocity(0.005, 0.0, 0.0, LIMITS) == pytest.approx(0.005, abs=1e-15)


def test_velocity_step_from_rest_rises_with_the_jerk_limit() -> None:
    velocity = limit_velocity(1.0, 0.0, 0.0, RateLimits(2.0, 10.0, 1000.0, 1.0))
    assert velocity == pytest.approx(1000.0 * PERIOD * PERIOD)


@pytest.mark.parametrize("limits", PANDA_RATE_LIMITS)
def test_random_velocities_never_break_a_limit(limits: RateLimits) -> None:
    rng = random.Random(5)
    last, acceleration = 0.0, 0.0
    for _ in range(5_000):
        velocity = limit_velocity(rng.uniform(-5, 5), last, acceleration, limits)
        new_acceleration = (velocity - last) / PERIOD
        assert abs(velocity) <= limits.velocity + 1e-12
        assert abs(new_acceleration) <= limits.acceleration + 1e-9
        last, acceleration = velocity, new_acceleration


def test_position_command_within_the_limits_passes() -> None:
    q = dq = ddq = 0.0
    for cycle in range(1, 2_000):
        wanted = 0.5 * (1.0 - math.cos(1.5 * cycle * PERIOD))
        reached = limit_position(wanted, q, dq, ddq, LIMITS)
        assert reached == pytest.approx(wanted, abs=1e-12)
        velocity = (reached - q) / PERIOD
        q, dq, ddq = reached, velocity, (velocity - dq) / PERIOD
