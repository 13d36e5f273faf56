"""The page of memory that the loop and its watchdog share."""

import mmap
import os

import pytest

from station.core.loop.heartbeat import PAGE_BYTES, Heartbeat, LoopLife, Phase


@pytest.fixture
def pages():
    """Return two mappings of one page, as two processes have them."""
    descriptor = os.memfd_create("test")
    os.ftruncate(descriptor, PAGE_BYTES)
    yield tuple(Heartbeat(mmap.mmap(descriptor, PAGE_BYTES)) for _ in range(2))
    os.close(descriptor)


def test_a_beat_is_seen_on_the_other_side(pages):
    station, watchdog = pages

    station.beats[0] = 12.5

    assert watchdog.beats[0] == 12.5


def test_life_and_phase_are_seen_on_the_other_side(pages):
    station, watchdog = pages

    station.life, station.phase = LoopLife.DIED, Phase.ENDING

    assert (watchdog.life, watchdog.phase) == (LoopLife.DIED, Phase.ENDING)


def test_a_stop_carries_its_reason_until_it_is_confirmed(pages):
    station, watchdog = pages
    assert not station.is_stop_asked

    watchdog.ask_stop("hung: wave_controller")

    assert station.is_stop_asked
    assert station.stop_reason() == "hung: wave_controller"
    station.confirm_stop()
    assert not watchdog.is_stop_asked


def test_a_shorter_reason_replaces_a_longer_one_wholly(pages):
    station, watchdog = pages

    watchdog.ask_stop("x" * 10_000)
    watchdog.ask_stop("short")

    assert station.stop_reason() == "short"


def test_the_end_is_noted_for_the_station(pages):
    station, watchdog = pages
    assert not station.is_ended_by_watchdog

    watchdog.note_end_by_watchdog()

    assert station.is_ended_by_watchdog
