"""Segments: the original's recorded answers, and what derivatives have to be."""

from itertools import pairwise

import numpy as np
import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import (
    PosVelAccState,
    QuinticSplineSegment,
    peak_speeds,
    through_waypoints,
)


def _state(recorded):
    return PosVelAccState(
        recorded["position"], recorded["velocity"], recorded["acceleration"]
    )


def _segment(recorded):
    return QuinticSplineSegment(
        recorded["start_time"],
        _state(recorded["start_state"]),
        recorded["end_time"],
        _state(recorded["end_state"]),
    )


def test_samples_are_those_of_the_original(vectors):
    assert len(vectors["segments"]) >= 100
    for recorded in vectors["segments"]:
        segment = _segment(recorded)
        assert segment.size == recorded["size"]
        assert segment.start_time == recorded["startTime()"]
        assert segment.end_time == recorded["endTime()"]
        for sample in recorded["samples"]:
            state = segment.sample(sample["time"])
            # The same operations in the same order: not a bit of difference.
            assert state.position == sample["state"]["position"]
            assert state.velocity == sample["state"]["velocity"]
            assert state.acceleration == sample["state"]["acceleration"]


def test_impossible_segments_are_refused_as_in_the_original(vectors):
    for recorded in vectors["exceptions"]:
        if recorded["exception"] is None:
            assert _segment(recorded).size == recorded["size"]
        else:
            with pytest.raises(InvalidTrajectoryError, match="can't be constructed"):
                _segment(recorded)


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        (PosVelAccState([0.0]), PosVelAccState([0.0, 1.0]), "1 and 2 positions"),
        (PosVelAccState(), PosVelAccState([0.0]), "no positions"),
        (
            PosVelAccState([0.0], [0.0]),
            PosVelAccState([0.0], [0.0, 1.0]),
            "1 and 2 velocities",
        ),
        (
            PosVelAccState([0.0], [0.0], [0.0, 0.0]),
            PosVelAccState([0.0], [0.0], [0.0]),
            "2 and 1 accelerations",
        ),
    ],
)
def test_the_message_says_what_does_not_fit(start, end, message):
    with pytest.raises(InvalidTrajectoryError, match=message):
        QuinticSplineSegment(0.0, start, 1.0, end)


def test_rates_are_derivatives_of_the_position():
    segment = QuinticSplineSegment(
        2.0,
        PosVelAccState([0.3], [-0.5], [1.0]),
        3.5,
        PosVelAccState([1.2], [0.4], [-2.0]),
    )
    step = 1e-5
    for time in (2.1, 2.7, 3.3):
        before, here, after = (
            segment.sample_dimension(time + shift) for shift in (-step, 0.0, step)
        )
        # Central differences are exact to step^2 times the third derivative, ~ 1e-9.
        assert here[1] == pytest.approx((after[0] - before[0]) / (2 * step), abs=1e-7)
        assert here[2] == pytest.approx((after[1] - before[1]) / (2 * step), abs=1e-7)


@pytest.mark.parametrize(
    ("velocity", "acceleration"), [([], []), ([0.7], []), ([0.7], [-0.2])]
)
def test_ends_are_met_as_far_as_they_are_specified(velocity, acceleration):
    end = PosVelAccState([1.0], velocity, acceleration)
    segment = QuinticSplineSegment(0.0, PosVelAccState([0.0], [0.1], [0.1]), 0.8, end)
    reached = segment.sample(0.8)
    assert reached.position == pytest.approx([1.0])
    if velocity:
        assert reached.velocity == pytest.approx(velocity)
    if acceleration:
        assert reached.acceleration == pytest.approx(acceleration)


@pytest.mark.parametrize(
    ("start", "end"),
    [
        (([], [0.3]), ([], [0.3])),
        (([0.2], [0.3]), ([], [])),
        (([], []), ([0.2], [0.3])),
        (([0.2], []), ([], [0.3])),
    ],
)
def test_rates_that_one_end_lacks_are_not_used(start, end):
    states = PosVelAccState([1.0], *start), PosVelAccState([2.0], *end)
    segment = QuinticSplineSegment(10.0, states[0], 12.0, states[1])
    assert segment.sample_dimension(10.5) == (1.25, 0.5, 0.0)
    assert segment.sample_dimension(11.5) == (1.75, 0.5, 0.0)


@pytest.mark.parametrize(("start", "end"), [([0.4], []), ([], [0.4])])
def test_accelerations_that_one_end_lacks_leave_a_cubic(start, end):
    states = PosVelAccState([0.0], [0.0], start), PosVelAccState([1.0], [0.0], end)
    segment = QuinticSplineSegment(0.0, states[0], 1.0, states[1])
    # 3 t^2 - 2 t^3
    assert segment.sample_dimension(0.5) == pytest.approx((0.5, 1.5, 0.0))
    assert segment.sample_dimension(0.25)[0] == pytest.approx(0.15625)


@pytest.mark.parametrize("rates", [([], []), ([0.7], []), ([0.7], [0.3])])
def test_a_segment_without_duration_is_its_start(rates):
    state = PosVelAccState([1.0], *rates)
    segment = QuinticSplineSegment(5.0, state, 5.0, PosVelAccState([9.0], *rates))
    assert segment.end_time == 5.0
    for time in (4.0, 6.0):
        assert segment.sample_dimension(time) == (1.0, 0.0, 0.0)
    velocity = rates[0][0] if rates[0] else 0.0
    acceleration = rates[1][0] if rates[1] else 0.0
    assert segment.sample_dimension(5.0) == (1.0, velocity, acceleration)


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
