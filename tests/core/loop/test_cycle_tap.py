"""Samples of every cycle while somebody reads them."""

import pytest

from station.core.loop.cycle_tap import CAPACITY, CycleTap
from station.testing import Bench


@pytest.fixture
def loop():
    return Bench().make_station().loop


def test_nothing_is_sampled_before_it_is_opened_and_after_it_is_closed(loop):
    calls = []
    tap = CycleTap(loop, lambda: calls.append(loop.cycle))
    loop.step(2)
    tap.open()
    loop.step(3)
    tap.close()
    loop.step(2)

    assert calls == [3, 4, 5]
    assert tap.newest_cycle() == 5


def test_each_cycle_has_its_number_epoch_stamp_and_period(loop):
    tap = CycleTap(loop, lambda: "x")
    tap.open()
    loop.delay_next_cycle(1)
    loop.step(2)

    (first, second), lost = tap.read_since(0)

    assert first == (1, 1, pytest.approx(0.002), pytest.approx(0.002), "x")
    assert second == (2, 1, pytest.approx(0.003), 0.001, "x")
    assert lost == 0


def test_a_reader_that_comes_late_learns_how_many_it_lost(loop):
    tap = CycleTap(loop, lambda: None)
    tap.open()
    loop.step(CAPACITY + 3)

    found, lost = tap.read_since(1)

    assert (len(found), lost) == (CAPACITY, 2)
    assert tap.read_since(loop.cycle) == ([], 0)


def test_a_tap_that_fails_says_why_and_hinders_no_other(loop):
    broken, sound = CycleTap(loop, lambda: [][0]), CycleTap(loop, lambda: 1)
    broken.open()
    sound.open()

    loop.step(2)

    assert broken.failure == "IndexError: list index out of range"
    assert len(sound.read_since(0)[0]) == 2
