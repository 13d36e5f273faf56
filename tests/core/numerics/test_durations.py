"""Percentiles of durations against NumPy over the same values."""

import numpy as np
import pytest

from station.core.numerics.durations import DurationRing


def test_an_empty_ring_summarises_to_zeros():
    summary = DurationRing().percentiles()
    assert (summary.p50, summary.p999, summary.max, summary.count) == (0, 0, 0, 0)


def test_percentiles_are_those_of_the_values():
    values = np.random.default_rng(3).exponential(1e-4, 500)
    ring = DurationRing(1000)
    for value in values:
        ring.add(float(value))
    summary = ring.percentiles()
    expected = np.percentile(values, (50, 99, 99.9))
    assert (summary.p50, summary.p99, summary.p999) == pytest.approx(tuple(expected))
    assert summary.max == values.max()
    assert summary.count == 500


def test_only_the_last_durations_count_but_the_maximum_stays():
    ring = DurationRing(4)
    for value in (9.0, 1.0, 1.0, 1.0, 1.0):
        ring.add(value)
    summary = ring.percentiles()
    assert summary.p999 == 1.0
    assert summary.max == 9.0
    assert summary.count == 5


def test_the_total_goes_on_after_a_reset():
    ring = DurationRing(4)
    for value in range(6):
        ring.add(float(value))
    ring.reset()
    ring.add(2.0)

    assert ring.added == 7
    assert ring.percentiles().count == 1


@pytest.mark.parametrize("before", range(6))
@pytest.mark.parametrize("after", range(1, 9))
def test_percentiles_after_a_reset_are_those_of_the_last_values(before, after):
    ring = DurationRing(4)
    for _ in range(before):
        ring.add(1000.0)
    ring.reset()
    for value in range(after):
        ring.add(float(value))

    summary = ring.percentiles()
    assert summary.count == after
    assert summary.max == after - 1
    assert summary.p50 == np.median(list(range(after))[-4:])


def test_reset_forgets_everything():
    ring = DurationRing(4)
    ring.add(9.0)
    ring.reset()
    ring.add(2.0)
    assert ring.percentiles().max == 2.0
    assert ring.percentiles().count == 1
