"""Who computes waits for a cycle that is about to begin, and for nothing else."""

import pytest

from station.core.clock import ManualClock
from station.core.loop.cycle_yield import HEAD_START, OVERDUE, PIECE, CycleYield
from station.core.loop.heartbeat import Heartbeat
from station.core.loop.simulation_speed import SimulationSpeed

PERIOD = 0.001
WOKE = 100.0


def waited(after: float, *, real_time_factor: float = 1.0) -> float:
    """Return how long a thread waits that looks so long after the last wake-up [s]."""
    heartbeat = Heartbeat()
    heartbeat.beats[0] = WOKE
    clock = ManualClock(WOKE + after)
    cycle_yield = CycleYield(
        clock, heartbeat, PERIOD, SimulationSpeed(real_time_factor)
    )
    cycle_yield.wait_if_cycle_is_due()
    return clock.now() - (WOKE + after)


def test_a_piece_that_ends_before_the_next_cycle_begins_at_once():
    assert waited(0.0) == 0.0
    assert waited(PERIOD - 1.1 * PIECE) == 0.0


def test_a_piece_that_would_last_into_the_next_cycle_waits_until_it_has_begun():
    after = PERIOD - 0.5 * PIECE
    assert waited(after) == pytest.approx(0.5 * PIECE + HEAD_START, abs=1e-9)


def test_a_late_cycle_is_waited_for_and_a_loop_that_hangs_is_not():
    assert waited(PERIOD + 0.5 * OVERDUE) == pytest.approx(HEAD_START, abs=1e-9)
    assert waited(PERIOD + 1.1 * OVERDUE) == 0.0
    assert waited(3600.0) == 0.0


def test_the_pace_decides_when_the_next_cycle_begins():
    after = 2 * PERIOD - 0.5 * PIECE
    assert waited(after, real_time_factor=0.5) > 0.0
    assert waited(0.5 * after, real_time_factor=0.5) == 0.0


def test_cycles_that_leave_no_room_between_them_are_not_waited_for():
    assert waited(0.9 * PERIOD / 100.0, real_time_factor=100.0) == 0.0


def test_a_loop_that_never_ran_is_not_waited_for():
    clock = ManualClock()
    before = clock.now()
    CycleYield(clock, Heartbeat(), PERIOD, SimulationSpeed()).wait_if_cycle_is_due()
    assert clock.now() == before
