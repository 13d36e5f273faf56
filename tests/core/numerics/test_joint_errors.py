"""Errors are the ways that joints can go, and the same in both modes."""

from math import isnan, nan, pi

import pytest
from hypothesis import given, strategies as st

from station.core.numerics.joint_errors import BOUNDED, CONTINUOUS, PLAIN, JointErrors
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both

WAYS = (PLAIN, CONTINUOUS, BOUNDED)


def errors_of(module_class, desired, measured, lower=-2.9, upper=2.9):
    errors = zeros(3)
    comparison = module_class(doubles(desired), doubles(measured), errors)
    for k, way in enumerate(WAYS):
        comparison.set_wrapping(k, way, lower, upper)
    comparison.compare()
    return errors.tolist()


def test_within_half_a_turn_the_error_is_the_difference():
    assert errors_of(JointErrors, [0.3] * 3, [0.1] * 3) == [0.3 - 0.1] * 3


def test_beyond_half_a_turn_each_joint_goes_the_way_it_can():
    found = errors_of(JointErrors, [-2.8] * 3, [2.8] * 3)
    assert found == pytest.approx([-5.6, 2 * pi - 5.6, -5.6])


def test_a_bounded_joint_takes_the_short_way_where_the_limits_allow_it():
    found = errors_of(JointErrors, [-2.8] * 3, [2.8] * 3, -7.0, 7.0)
    assert found[2] == pytest.approx(2 * pi - 5.6)


@pytest.mark.parametrize(("desired", "measured"), [(nan, 0.0), (0.0, nan)])
def test_an_unknown_position_has_no_error(desired, measured):
    assert all(map(isnan, errors_of(JointErrors, [desired] * 3, [measured] * 3)))


turns = st.lists(st.floats(-20.0, 20.0), min_size=3, max_size=3)


@needs_both
@given(st.one_of(turns, arrays(3)), st.one_of(turns, arrays(3)), arrays(2))
def test_both_modes_compare_the_same(desired, measured, limits):
    assert_same(
        "joint_errors",
        lambda module: errors_of(module.JointErrors, desired, measured, *limits),
    )


@needs_both
@given(arrays(4))
def test_both_modes_find_the_same_distances(values):
    start, end, lower, upper = values
    assert_same(
        "joint_errors",
        lambda module: [
            module.shortest_angular_distance(start, end),
            module.shortest_angular_distance_with_limits(start, end, lower, upper),
        ],
    )


@pytest.mark.parametrize(
    ("measured", "exceeds"), [(0.5, False), (-0.5, False), (0.6, True), (-0.6, True)]
)
def test_an_error_beyond_its_bound_is_seen_in_both_directions(measured, exceeds):
    comparison = JointErrors(zeros(2), doubles([0.0, measured]), zeros(2))
    comparison.set_bound(1, 0.5)
    comparison.compare()
    assert comparison.exceeds() is exceeds


@needs_both
@given(arrays(3), arrays(3), arrays(3))
def test_both_modes_see_the_same_excess(desired, measured, bounds):
    def scenario(module):
        comparison = module.JointErrors(doubles(desired), doubles(measured), zeros(3))
        for k, bound in enumerate(bounds):
            comparison.set_bound(k, bound)
        comparison.compare()
        return [float(comparison.exceeds())]

    assert_same("joint_errors", scenario)
