"""Angles: checked against complex numbers and against a search over whole turns."""

import cmath
from math import inf, isnan, pi

import pytest

from station.core.numerics.joint_errors import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)

ANGLES = [-9.5, -pi, -3.0, -1.0, -1e-9, 0.0, 0.3, 1.5, 3.1, pi, 4.0, 12.0]


@pytest.mark.parametrize("start", ANGLES)
@pytest.mark.parametrize("end", ANGLES)
def test_the_shortest_turn_is_the_argument_of_the_quotient(start, end):
    expected = cmath.phase(cmath.exp(1j * end) / cmath.exp(1j * start))
    turn = shortest_angular_distance(start, end)
    # A turn of pi may come out with either sign; both lead to `end`.
    assert abs(turn) == pytest.approx(abs(expected), abs=1e-12)
    assert cmath.exp(1j * (start + turn)) == pytest.approx(cmath.exp(1j * end))


@pytest.mark.parametrize("start", [-2.9, -2.0, -0.5, 0.0, 1.0, 2.0, 2.9])
@pytest.mark.parametrize("end", [-2.9, -2.0, -0.5, 0.0, 1.0, 2.0, 2.9])
def test_within_less_than_a_turn_of_range_the_way_is_the_difference(start, end):
    turn = shortest_angular_distance_with_limits(start, end, -2.9, 2.9)
    assert turn == pytest.approx(end - start, abs=1e-12)


def test_over_more_than_a_turn_of_range_the_short_way_wins():
    assert shortest_angular_distance_with_limits(-3.0, 3.0, -4.0, 4.0) == pytest.approx(
        6.0 - 2 * pi
    )


def test_the_shorter_way_is_returned_when_neither_ends_within_the_limits():
    assert shortest_angular_distance_with_limits(0.0, 2.0, -1.0, 1.0) == 2.0


@pytest.mark.parametrize("bad", [inf, -inf, float("nan")])
def test_an_angle_that_is_not_finite_has_no_distance(bad):
    assert isnan(shortest_angular_distance(0.0, bad))
    assert isnan(shortest_angular_distance_with_limits(0.0, bad, -1.0, 1.0))
