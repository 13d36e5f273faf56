"""What repeats is counted, and nothing of it is forgotten."""

import pytest

from station.events.event_file import Origin
from station.events.event_log import EventLog
from station.events.repeats import FREE, MOST_KINDS, WINDOW, Repeats
from station.reports import EventKind


class Time:
    """A clock that is set by hand."""

    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def time():
    return Time()


@pytest.fixture
def log():
    return EventLog()


@pytest.fixture
def repeats(log, time):
    return Repeats(log, time)


def ask(repeats, times, what="PUT /x", **given):
    for _ in range(times):
        repeats.record(
            EventKind.REQUEST, "t", what=what, result="200", origin=Origin("a"), **given
        )


def test_the_first_ones_are_recorded_and_the_others_counted(log, repeats, time):
    ask(repeats, FREE + 90)
    assert len(log.since()) == FREE
    time.now += WINDOW
    repeats.flush()

    assert log.since()[-1].details == {"repeated": 90, "first_event": 1}


@pytest.mark.parametrize(("times", "words"), [(2, "once more"), (3, "2 more times")])
def test_the_text_says_how_often_it_happened_again(log, repeats, times, words):
    ask(repeats, times, free=1)
    repeats.finish()

    assert log.since()[-1].text.startswith(f"{words} within 10 s: ")


def test_after_the_window_it_begins_anew(log, repeats, time):
    ask(repeats, 5, free=1)
    time.now += WINDOW
    ask(repeats, 1, free=1)

    assert [e.details.get("repeated") for e in log.since()] == [None, 4, None]


def test_what_differs_is_not_counted_together(log, repeats):
    ask(repeats, 1, "PUT /x", free=1)
    ask(repeats, 1, "PUT /y", free=1)

    assert len(log.since()) == 2


def test_a_window_that_has_no_repeats_says_nothing(log, repeats, time):
    ask(repeats, 3)
    time.now += WINDOW
    repeats.flush()

    assert len(log.since()) == 3


def test_memory_is_bounded_and_counts_are_told(log, repeats):
    ask(repeats, 7, "PUT /first", free=1)
    for number in range(MOST_KINDS):
        ask(repeats, 1, f"PUT /{number}")

    assert len(repeats._windows) == MOST_KINDS
    assert any(event.details.get("repeated") == 6 for event in log.recent(0))


def test_the_end_tells_what_is_still_counted(log, repeats):
    ask(repeats, 3, free=1)
    repeats.finish()

    assert log.since()[-1].details["repeated"] == 2
