"""Splines of several joints at once, and the same in both modes."""

from itertools import chain

import pytest
from hypothesis import given, strategies as st

from station.core.trajectory.splines import SPLINE_SIZE, sample_splines
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

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


times = st.one_of(st.floats(-1.0, 4.0), numbers)


@needs_both
@given(
    st.lists(st.tuples(times, times, arrays(6)), min_size=1, max_size=4),
    st.booleans(),
    times,
)
def test_both_modes_sample_the_same(curves, share_times, time):
    def scenario(module):
        states = zeros(3 * len(curves))
        numbers = []
        for start, duration, coefficients in curves:
            ends = curves[0][:2] if share_times else (start, duration)
            numbers += [*ends, *coefficients]
        return [float(module.sample_splines(doubles(numbers), time, states)), *states]

    assert len(curves[0][2]) + 2 == SPLINE_SIZE
    assert_same("splines", scenario)
