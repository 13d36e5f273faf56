"""Splines of several joints at once, and the same in both modes."""

from itertools import chain

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.core.numerics import joint_errors
from station.core.trajectory import splines
from station.core.trajectory.splines import (
    EXCEEDS,
    IS_OVER,
    SPLINE_SIZE,
    sample_splines,
)
from station.memory.doubles import doubles, zeros
from tests.both_modes import (
    arrays,
    assert_same,
    compiled,
    interpreted,
    needs_both,
    numbers,
)

# From 1 s to 3 s: x = 1 + 2 t + 3 t^2, and x = t^5 from 1 s to 2 s.
CURVE = [1.0, 2.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0]
POWER = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def states_at(time, *curves):
    """Return positions, velocities and accelerations, and whether all are over."""
    states = zeros(3 * len(curves))
    is_over = sample_splines(doubles(chain(*curves)), time, states)
    return states.tolist(), is_over


@pytest.mark.parametrize(
    ("time", "states", "is_over"),
    [
        (0.9, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], False),
        (1.5, [2.75, 0.5**5, 5.0, 5 * 0.5**4, 6.0, 20 * 0.5**3], False),
        (2.5, [10.75, 1.0, 11.0, 0.0, 6.0, 0.0], False),
        (3.5, [17.0, 1.0, 0.0, 0.0, 0.0, 0.0], True),
    ],
)
def test_each_joint_follows_its_own_spline(time, states, is_over):
    assert states_at(time, CURVE, POWER) == (states, is_over)


def make_group(errors, splines, size):
    """Return a group whose joints are measured at 0, the states, and the errors."""
    states, found = zeros(3 * size), zeros(2 * size)
    comparisons = []
    for first in (0, size):
        piece = slice(first, first + size)
        comparisons.append(errors.JointErrors(states[piece], zeros(size), found[piece]))
    return splines.SplineGroup(states, *comparisons), states, found, comparisons


def test_another_speed_scales_the_rates_and_not_the_path():
    group, states, errors, _ = make_group(joint_errors, splines, 2)
    for k, spline in enumerate([CURVE, POWER]):
        group.load(k, doubles(spline))
    group.follow(1.5, 0.5, 2.0)
    assert states.tolist() == [
        *(2.75, 0.5**5),
        *(2.5, 2.5 * 0.5**4),
        *(6.0 * 0.25 + 2.0 * 5.0, 5.0 * 0.5**3 + 10 * 0.5**4),
    ]
    assert errors.tolist() == states[:4].tolist()


@pytest.mark.parametrize(
    ("time", "bounds", "mask"),
    [
        (1.5, (2.75, 5.0), 0),
        (1.5, (2.7, 5.0), EXCEEDS),
        (1.5, (2.75, 4.9), EXCEEDS),
        (3.5, (17.0, 0.0), IS_OVER),
        (3.5, (16.9, 0.0), IS_OVER | EXCEEDS),
    ],
)
def test_the_mask_tells_of_the_end_and_of_errors_beyond_bounds(time, bounds, mask):
    group, _, _, comparisons = make_group(joint_errors, splines, 1)
    for comparison, bound in zip(comparisons, bounds, strict=True):
        comparison.set_bound(0, bound)
    group.load(0, doubles(CURVE))
    assert group.follow(time, 1.0, 0.0) == mask


times = st.one_of(st.floats(-1.0, 4.0), numbers)


@needs_both
@given(
    st.lists(st.tuples(times, times, arrays(6)), min_size=1, max_size=4),
    st.booleans(),
    st.tuples(times, numbers, numbers),
)
def test_both_modes_sample_the_same(curves, share_times, moment):
    def scenario(module):
        errors = (interpreted if module.__file__.endswith(".py") else compiled)(
            "joint_errors"
        )
        group, states, found, _ = make_group(errors, module, len(curves))
        for k, (start, duration, coefficients) in enumerate(curves):
            ends = curves[0][:2] if share_times else (start, duration)
            group.load(k, doubles([*ends, *coefficients]))
        return [float(group.follow(*moment)), *states, *found]

    assert len(curves[0][2]) + 2 == SPLINE_SIZE
    assert_same("splines", scenario)
