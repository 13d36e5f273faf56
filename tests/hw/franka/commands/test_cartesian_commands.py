"""Cartesian commands keep to the limits of velocity, acceleration and jerk."""

from math import sqrt

import pytest

from station.hw.franka.arm.arm_limits import MotionLimits
from tests.hw.franka.limited_vectors import limited

LIMITS = MotionLimits(2.0, 13.0, 6500.0)
PERIOD = 0.001


def norm(vector):
    return sqrt(sum(value * value for value in vector))


def test_step_is_approached_within_all_limits():
    v, a = [0.0] * 3, [0.0] * 3
    for _ in range(2_000):
        new = limited([3.0, -3.0, 1.0], v, a, LIMITS)
        acceleration = [(x - y) / PERIOD for x, y in zip(new, v, strict=True)]
        jerk = [(x - y) / PERIOD for x, y in zip(acceleration, a, strict=True)]
        assert norm(new) <= 2.0 + 1e-9
        assert norm(acceleration) <= 13.0 + 1e-6
        assert norm(jerk) <= 6500.0 * (1 + 1e-6)
        v, a = new, acceleration
    assert norm(v) == pytest.approx(2.0, abs=0.02)


def test_command_within_the_limits_passes():
    assert limited([1e-6, 0, 0], [0.0] * 3, [0.0] * 3, LIMITS) == pytest.approx([
        1e-6,
        0.0,
        0.0,
    ])
