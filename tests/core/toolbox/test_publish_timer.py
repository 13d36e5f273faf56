"""The rhythm of publications."""

import pytest
from hypothesis import given, strategies as st

from station.core.toolbox.publish_timer import PublishTimer
from tests.both_modes import assert_same, needs_both, numbers


def _due(timer, times):
    return [time for time in times if timer.is_due(time)]


def test_a_publish_timer_keeps_its_rate_at_any_cycle_time():
    timer = PublishTimer(10.0)
    timer.start(5.0, at_once=False)
    due = _due(timer, [5.0 + 0.003 * cycle for cycle in range(1000)])
    assert len(due) == 29


def test_the_first_publication_is_at_once_or_after_an_interval():
    at_once, later = PublishTimer(10.0), PublishTimer(10.0)
    at_once.start(5.0, at_once=True)
    later.start(5.0, at_once=False)
    times = [5.0 + 0.01 * cycle for cycle in range(1, 20)]
    assert _due(at_once, times)[0] == pytest.approx(5.01)
    assert _due(later, times)[0] == pytest.approx(5.11)


def test_starting_again_keeps_the_rhythm():
    timer = PublishTimer(10.0)
    timer.start(5.0, at_once=False)
    timer.start(5.05, at_once=True)
    assert not timer.is_due(5.06)


def test_missed_publications_are_left_out():
    timer = PublishTimer(10.0)
    timer.start(5.0, at_once=False)
    assert _due(timer, [9.0, 9.01, 9.02, 9.11]) == [9.0, 9.11]


@pytest.mark.parametrize("rate", [0.0, -3.0])
def test_a_rate_that_is_not_positive_is_never_due(rate):
    timer = PublishTimer(rate)
    timer.start(5.0, at_once=True)
    assert _due(timer, [6.0, 7.0]) == []


def test_nothing_is_due_before_the_start():
    assert not PublishTimer(10.0).is_due(5.0)


@needs_both
@given(numbers, st.lists(numbers, max_size=6), st.booleans())
def test_both_modes_agree_bit_for_bit(rate, times, at_once):
    def scenario(module):
        timer = module.PublishTimer(rate)
        timer.start(0.0, at_once)
        return [float(timer.is_due(time)) for time in times]

    assert_same("publish_timer", scenario)
