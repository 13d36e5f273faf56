"""Limits of Panda and FR3."""

from math import sqrt

import pytest

from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.franka.commands.rate_limiter import rate_limits_of


def test_pandas_velocity_does_not_depend_on_the_position():
    assert PANDA_LIMITS.velocity_range(0, 2.8) == (-2.175, 2.175)


def test_fr3_slows_down_towards_its_limits():
    assert FR3_LIMITS.velocity_range(0, 0.0) == (-2.62, 2.62)
    low, high = FR3_LIMITS.velocity_range(0, 2.7)
    assert high == pytest.approx(sqrt(12.0 * (2.7501 - 2.7)) - 0.3)
    assert low == -2.62
    assert FR3_LIMITS.velocity_range(0, 2.75)[1] == 0.0


def test_limiter_maxima_are_libfrankas():
    panda = [limits.velocity for limits in rate_limits_of(PANDA_LIMITS)]
    expected = [2.129, 2.1515, 2.144, 2.1365, 2.564, 2.549, 2.549]
    assert panda == pytest.approx(expected, abs=1e-5)
    # FR3: no lost packet is tolerated.
    assert rate_limits_of(FR3_LIMITS)[0].velocity == pytest.approx(2.619)
