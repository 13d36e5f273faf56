"""The speed along a path, against what its bounds allow in closed form."""

import numpy as np
import pytest

from station.core.trajectory.speed_law import SpeedBounds, SpeedLaw

BOUNDS = SpeedBounds(0.5, 2.0, 20.0)


def test_a_long_way_takes_the_time_of_its_ramps_and_of_the_rest_at_speed():
    law = SpeedLaw.between(0.0, 0.0, 1.0, BOUNDS)
    # v / a + a / j = 0.35 s for each ramp, with half the speed in the mean.
    assert law.duration == pytest.approx(2 * 0.35 + (1.0 - 0.35 * 0.5) / 0.5)
    length, speed, acceleration = law.at(law.duration)
    assert length == pytest.approx(1.0)
    assert (speed, acceleration) == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("begin", "end", "length"),
    [(0.0, 0.0, 1e-4), (0.0, 0.3, 0.06), (0.4, 0.0, 0.2), (0.3, 0.3, 0.02)],
)
def test_bounds_hold_on_short_ways(begin, end, length):
    law = SpeedLaw.between(begin, end, length, BOUNDS)
    times = np.linspace(0.0, law.duration, 2001)
    s, v, a = np.array([law.at(t) for t in times]).T
    assert s[-1] == pytest.approx(length)
    assert (v[0], v[-1]) == pytest.approx((begin, end), abs=1e-9)
    assert v.max() <= BOUNDS.speed + 1e-9
    assert np.abs(a).max() <= BOUNDS.acceleration + 1e-9
    jerk = np.abs(np.diff(a)).max() / times[1]
    assert jerk <= BOUNDS.jerk * (1 + 1e-6)
    assert np.diff(s) == pytest.approx(0.5 * (v[1:] + v[:-1]) * times[1], abs=1e-9)


def test_the_speed_that_a_length_allows_needs_the_whole_length():
    reached = BOUNDS.reached_from(0.1, 0.03)
    assert 0.1 < reached < BOUNDS.speed
    assert BOUNDS.way(0.1, reached) == pytest.approx(0.03)
    assert BOUNDS.reached_from(0.1, 10.0) == BOUNDS.speed
    assert BOUNDS.reached_from(0.1, 0.0) == 0.1
