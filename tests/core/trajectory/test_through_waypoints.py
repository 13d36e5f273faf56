"""A trajectory through waypoints: where it passes, how fast, never astray."""

from itertools import pairwise

import numpy as np
import pytest

from station.core.trajectory import (
    PosVelAccState,
    QuinticSplineSegment,
    peak_speeds,
    through_waypoints,
)


def sampled(start, states):
    """Return the first joint's positions along the whole way."""
    rest = [0.0] * len(start)
    known = [PosVelAccState(list(start), rest, rest), *states]
    found = []
    for one, other in pairwise(known):
        begin, end = one.time_from_start, other.time_from_start
        segment = QuinticSplineSegment(begin, one, end, other)
        found += [segment.sample(t).position[0] for t in np.linspace(begin, end, 200)]
    return np.array(found)


def test_a_single_way_is_the_one_of_least_jerk():
    """From rest to rest its peak is 15/8 of the mean speed, as of least jerk."""
    states = through_waypoints([0.0], [[1.2]], [2.0])
    assert peak_speeds([0.0], states)[0][0] == pytest.approx(
        15 / 8 * 1.2 / 2.0, rel=1e-3
    )


def test_a_joint_passes_waypoints_without_standing_still():
    """At equal mean speeds on both sides it passes with that speed."""
    states = through_waypoints([0.0], [[1.0], [2.0]], [1.0, 2.0])
    assert states[0].velocity == pytest.approx([1.0])
    assert states[1].velocity == [0.0]


@pytest.mark.parametrize("after", [0.4, 1.0])
def test_a_joint_that_turns_round_or_waits_is_at_rest_there(after):
    states = through_waypoints([0.0], [[1.0], [after]], [1.0, 2.0])
    assert states[0].velocity == [0.0]


def test_it_never_goes_beyond_its_waypoints():
    """For a hundred random paths, of very unequal ways and times."""
    random = np.random.default_rng(7)
    for _ in range(100):
        places = random.uniform(-2.0, 2.0, (6, 1)) ** 3
        times = np.cumsum(random.uniform(0.05, 3.0, 6))
        states = through_waypoints([0.0], places.tolist(), times.tolist())
        way = sampled([0.0], states)
        # The tolerance is that of doubles at values of up to 8.
        knots = [0.0, *places[:, 0]]
        for i, (a, b) in enumerate(pairwise(knots)):
            part = way[200 * i : 200 * (i + 1)]
            assert part.min() >= min(a, b) - 1e-9
            assert part.max() <= max(a, b) + 1e-9
