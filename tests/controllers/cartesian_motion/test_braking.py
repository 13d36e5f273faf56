"""Ways to rest against Ruckig, and both modes."""

import pytest
from hypothesis import given, settings, strategies as st

from station.controllers.cartesian_motion.pose_motion import (
    braking_peaks,
    peak_speed,
    resting_ways,
)
from station.controllers.smoothed_motion.axis_limits import AxisLimits
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both

states = st.tuples(st.floats(-1.0, 1.0), st.floats(-2.0, 2.0))
limits = st.tuples(st.floats(2.0, 5.0), st.floats(1.0, 80.0))


@given(states, limits)
def test_the_way_to_rest_is_that_of_the_time_optimal_motion(state, limit):
    (v, a), (largest, jerk), way = state, limit, zeros(1)
    generator = MotionGenerator(AxisLimits((1.0,), (largest,), (jerk,)))
    generator.start([0.0], [0.0])
    generator.restore(([0.0], [v], [a]))
    resting_ways(*(doubles([each]) for each in (v, a, largest, jerk)), way)

    assert way[0] == pytest.approx(generator.resting_positions()[0], abs=1e-7)


def test_peaks_are_against_the_velocities_and_limited():
    v, a, largest, jerk = ([2.0, -0.5], [0.0, 0.0], [1.5, 9.0], [8.0, 8.0])
    peaks = zeros(2)
    braking_peaks(*(doubles(each) for each in (v, a, largest, jerk)), peaks)

    assert peaks.tolist() == [-1.5, 2.0]


def test_an_axis_that_accelerates_becomes_faster_while_it_brakes():
    jerk = doubles([4.0, 4.0])

    assert peak_speed(doubles([3, 0]), doubles([0, 0]), jerk) == 3.0
    assert peak_speed(doubles([2.5, 0]), doubles([2, 0]), jerk) == 3.0
    assert peak_speed(doubles([0, 4]), doubles([4, 0]), jerk) == pytest.approx(20**0.5)


@needs_both
@settings(max_examples=100)
@given(arrays(6), arrays(6), st.lists(limits, min_size=6, max_size=6))
def test_both_modes_agree_bit_for_bit(velocities, accelerations, bounds):
    def scenario(module):
        ways, peaks = zeros(6), zeros(6)
        v, a = doubles(velocities), doubles(accelerations)
        largest, jerk = (doubles(each) for each in zip(*bounds, strict=True))
        module.resting_ways(v, a, largest, jerk, ways)
        module.braking_peaks(v, a, largest, jerk, peaks)
        return [*ways, *peaks, module.peak_speed(v, a, jerk)]

    assert_same("pose_motion", scenario)
