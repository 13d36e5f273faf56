"""What the charts are drawn from."""

import numpy as np
import pytest

from station.ui.plot_history import MAX_POINTS, AxisRange, PlotHistory
from tests.ui.views import sample


def test_curves_end_at_the_newest_sample_and_cover_one_window():
    history = PlotHistory()
    for i in range(100):
        history.append(sample(0.1 * i, desired=1.0, actual=float(i), error=-1.0))
    curves = history.curves(0, window=2.0)
    assert curves.time[-1] == 0.0
    assert curves.time[0] == pytest.approx(-2.0, abs=1e-9)
    assert curves.actual[-1] == 99.0
    assert set(curves.desired) == {1.0}


def test_an_empty_history_draws_nothing():
    assert len(PlotHistory().curves(0, 5.0).time) == 0


def test_a_restarted_clock_starts_afresh():
    history = PlotHistory()
    history.append(sample(50.0))
    history.append(sample(1.0, actual=2.0))
    assert list(history.curves(0, 1e3).actual) == [2.0]


def test_the_same_sample_counts_once():
    history = PlotHistory()
    history.append(sample(1.0))
    history.append(sample(1.0))
    assert len(history.curves(0, 5.0).time) == 1


def test_absent_numbers_are_gaps():
    history = PlotHistory()
    history.append(sample(1.0, desired=None))
    assert np.isnan(history.curves(0, 5.0).desired[0])


def test_a_long_history_is_thinned_out_but_keeps_its_peaks():
    history = PlotHistory()
    for i in range(5000):
        history.append(sample(0.01 * i, actual=9.0 if i == 2345 else 0.0))
    curves = history.curves(0, window=100.0)
    assert len(curves.time) <= MAX_POINTS
    assert curves.actual.max() == 9.0
    assert np.all(np.diff(curves.time) > 0.0)


def test_an_axis_holds_all_values_and_stays_while_they_fit():
    axis = AxisRange()
    first = axis.fit(np.array([0.0, 1.0]))
    assert first[0] <= 0.0
    assert first[1] >= 1.0
    assert axis.fit(np.array([0.2, 0.9])) == first


def test_an_axis_grows_and_shrinks_with_the_values():
    axis = AxisRange()
    small = axis.fit(np.array([0.0, 0.1]))
    large = axis.fit(np.array([0.0, 5.0]))
    assert large[1] >= 5.0 > small[1]
    assert axis.fit(np.array([0.0, 0.1]))[1] < 1.0


def test_a_constant_is_not_blown_up():
    low, high = AxisRange(least=0.02).fit(np.array([0.7, 0.7]))
    assert high - low >= 0.02
    assert low < 0.7 < high


def test_an_axis_of_gaps_keeps_its_ends():
    assert AxisRange().fit(np.array([np.nan])) == (-1.0, 1.0)
