"""Batches of every cycle, from the ring and from a tap."""

import pytest

from station.api.streams.cycle_samples import TapSamples
from station.api.streams.topics import find_topic
from station.core.loop.cycle_tap import CAPACITY
from tests.api.spring import make_station


@pytest.fixture
def station():
    return make_station()


def samples_of(station):
    return find_topic(station, "joint_states").every_cycle()


def tapped(station, take):
    samples = TapSamples(station, take, lambda value: {"value": value}, limit=10)
    samples.open()
    return samples


def test_batches_go_on_where_the_client_is(station):
    station.loop.step(10)
    samples = samples_of(station)

    first = samples.since(2, 7)
    assert [s["cycle"] for s in first.data["samples"]] == [3, 4, 5, 6, 7]
    assert (first.cycle, first.data["lost"]) == (7, 0)
    rest = samples.since(first.cycle, 50)
    assert [s["cycle"] for s in rest.data["samples"]] == [8, 9, 10]
    assert samples.since(10, 50) is None


def test_a_batch_says_how_many_cycles_were_overwritten(station):
    station.loop.step(5000)

    batch = samples_of(station).since(100, 200)

    first = batch.data["samples"][0]["cycle"]
    assert batch.data["lost"] == first - 101 > 0


def test_deadlines_that_were_skipped_are_told_apart_from_lost_cycles(station):
    station.loop.step(3)
    station.loop.delay_next_cycle(20)
    station.loop.step(2)

    batch = samples_of(station).since(1, 5)

    assert [s["cycle"] for s in batch.data["samples"]] == [2, 3, 4, 5]
    assert (batch.data["lost"], batch.data["skipped"]) == (0, 20)


def test_a_tap_takes_every_cycle_in_batches(station):
    samples = tapped(station, lambda: 7)
    station.loop.step(15)

    first = samples.since(0, samples.newest_cycle())
    rest = samples.since(first.cycle, samples.newest_cycle())

    assert [s["cycle"] for s in first.data["samples"]] == list(range(1, 11))
    assert first.data["samples"][0] == {"cycle": 1, "stamp": 0.001, "value": 7}
    assert [s["cycle"] for s in rest.data["samples"]] == list(range(11, 16))


def test_a_tap_says_what_it_lost(station):
    samples = tapped(station, lambda: 7)
    station.loop.step(CAPACITY + 20)

    assert samples.since(0, samples.newest_cycle()).data["lost"] == 20


def test_a_sample_that_cannot_be_taken_ends_the_stream_and_not_the_loop(station):
    samples = tapped(station, lambda: 1 / 0)
    station.loop.step(2)

    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        samples.newest_cycle()
    assert station.loop.cycle == 2
