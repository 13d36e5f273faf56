"""Clocks: the wall's, and one that stands still."""

import threading

import pytest

from station.core.clock import ManualClock, SystemClock
from tests.core.loop.one_joint import OneJoint, make_loop


def test_the_manual_clock_stands_still_until_it_is_advanced():
    clock = ManualClock(10.0)
    assert clock.now() == clock.now() == 10.0

    clock.advance(0.5)

    assert clock.now() == 10.5


def test_the_manual_clock_does_not_go_back():
    clock = ManualClock(10.0)

    with pytest.raises(ValueError, match="-1"):
        clock.advance(-1.0)
    clock.sleep_until(3.0)

    assert clock.now() == 10.0


def test_sleeping_on_the_manual_clock_advances_it():
    clock = ManualClock(10.0)

    clock.sleep_until(12.0)

    assert clock.now() == 12.0


@pytest.mark.parametrize("clock", [ManualClock(), SystemClock()])
def test_a_free_lock_is_acquired_at_once(clock):
    lock = threading.Lock()
    before = clock.now()

    assert clock.wait_for(lock, before + 60.0)

    assert lock.locked()
    assert clock.now() - before < 30.0


@pytest.mark.parametrize("clock", [ManualClock(), SystemClock()])
def test_a_held_lock_is_given_up_at_the_deadline(clock):
    lock = threading.Lock()
    lock.acquire()
    deadline = clock.now() + 0.01

    assert not clock.wait_for(lock, deadline)

    assert clock.now() >= deadline - 0.001


def test_the_system_clock_sleeps_until_the_deadline_and_not_before():
    clock = SystemClock()
    deadline = clock.now() + 0.002

    clock.sleep_until(deadline)

    assert clock.now() >= deadline


def test_a_deadline_that_has_passed_is_not_slept_for():
    clock = SystemClock()
    before = clock.now()

    clock.sleep_until(before - 100.0)

    assert clock.now() - before < 1.0


def test_virtual_time_passes_before_each_cycle_that_is_stepped():
    seen = []

    class Watching(OneJoint):
        def read(self, time, period):
            seen.append(loop.clock.now())

    loop = make_loop(Watching(), clock=ManualClock(10.0))
    loop.step(2, tick=0.25)
    loop.delay_next_cycle(1)
    loop.step(tick=0.25)

    assert seen == [10.25, 10.5, 10.75]
