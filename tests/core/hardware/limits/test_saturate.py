"""Clipping keeps what is inside, and follows min and max everywhere else."""

from math import copysign, inf, nan

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.core.hardware.limits.saturate import saturate, soft_velocity_bound

numbers = st.floats(allow_nan=False)


@settings(derandomize=True)
@given(value=numbers, low=numbers, high=numbers)
def test_result_is_min_of_max_also_for_inverted_bounds(value, low, high):
    assert saturate(value, low, high) == min(max(value, low), high)


@pytest.mark.parametrize(
    ("value", "expected"), [(-inf, -1.0), (-1.5, -1.0), (0.5, 0.5), (inf, 2.0)]
)
def test_value_outside_becomes_the_nearer_bound(value, expected):
    assert saturate(value, -1.0, 2.0) == expected


def test_nan_is_returned_as_it_is():
    result = saturate(nan, -1.0, 1.0)
    assert result != result  # only NaN differs from itself


def test_negative_zero_keeps_its_sign_at_a_zero_bound():
    assert copysign(1.0, saturate(-0.0, 0.0, 1.0)) == -1.0


@pytest.mark.parametrize(
    ("position", "velocity"),
    [(0.0, 2.0), (0.9, 1.0), (1.0, 0.0), (1.1, -1.0), (5.0, -2.0)],
)
def test_soft_bound_slows_down_stops_and_sends_back(position, velocity):
    assert soft_velocity_bound(position, 1.0, 10.0, 2.0) == pytest.approx(velocity)
