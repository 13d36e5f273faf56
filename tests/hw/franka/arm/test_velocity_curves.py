"""Velocity limits that depend on the position, against numpy and in both modes."""

import numpy as np
import pytest
from hypothesis import given

from station.hw.franka.arm.arm_limits import FR3_LIMITS
from station.hw.franka.arm.velocity_curves import VelocityCurves
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both


def test_limits_are_those_of_libfrankas_formula():
    offset, slope, upper, lower = np.array(FR3_LIMITS.curves).T
    most = np.array(FR3_LIMITS.velocity)
    curves = VelocityCurves(FR3_LIMITS.velocity, FR3_LIMITS.curves, [0.0] * 7)
    for q in np.random.default_rng(6).uniform(lower - 0.1, upper + 0.1, (500, 7)):
        lowest, highest = zeros(7), zeros(7)
        curves.put(doubles(q), lowest, highest)
        up = np.sqrt(np.maximum(0.0, slope * (upper - q))) - offset
        down = np.sqrt(np.maximum(0.0, slope * (q - lower))) - offset
        assert highest.tolist() == pytest.approx(np.clip(up, 0.0, most), abs=1e-12)
        assert lowest.tolist() == pytest.approx(-np.clip(down, 0.0, most), abs=1e-12)


def test_joint_at_an_unknown_position_may_not_move():
    lowest, highest = doubles([-9.0] * 7), doubles([9.0] * 7)
    curves = VelocityCurves(FR3_LIMITS.velocity, FR3_LIMITS.curves, [0.0] * 7)
    curves.put(doubles([float("nan")] * 7), lowest, highest)
    assert lowest.tolist() == highest.tolist() == [0.0] * 7


@needs_both
@given(arrays(7))
def test_both_modes_agree_bit_for_bit(q):
    def scenario(module):
        lowest, highest = zeros(7), zeros(7)
        curves = module.VelocityCurves(
            FR3_LIMITS.velocity, FR3_LIMITS.curves, [0.0] * 7
        )
        curves.put(doubles(q), lowest, highest)
        return [*lowest, *highest]

    assert_same("velocity_curves", scenario)
