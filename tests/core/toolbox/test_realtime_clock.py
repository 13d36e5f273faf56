"""Estimated system time."""

import random

import pytest

from station.core.toolbox.realtime import RealtimeClock


def test_before_a_measurement_it_is_the_control_threads_time():
    assert RealtimeClock().get_system_time(5.0) == 5.0


def test_the_first_measurement_sets_the_offset():
    clock = RealtimeClock()
    clock.measure(105.0)

    assert clock.get_system_time(5.0) == 105.0
    assert clock.get_system_time(6.0) == 106.0


def test_half_a_cycle_is_added_to_a_measurement():
    clock = RealtimeClock()
    clock.get_system_time(1.0)
    clock.measure(101.5)

    assert clock.get_system_time(2.0) == 102.0


def test_jitter_of_measurements_is_filtered():
    clock, dice, period = RealtimeClock(), random.Random(5), 0.001
    estimates = []
    for cycle in range(1, 20_000):
        time = cycle * period
        # Measured at any moment of the cycle before this one.
        clock.measure(1000.0 + time - dice.random() * period)
        estimates.append(clock.get_system_time(time) - time)

    # The first measurement may be half a cycle off; the filter keeps 13 % of that
    # after 20 000 cycles, and the jitter itself averages out.
    assert estimates[-1] == pytest.approx(1000.0, abs=0.15 * period)
