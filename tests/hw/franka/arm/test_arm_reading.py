"""How often an arm is read in a cycle of the loop, and what follows."""

import pytest
from typing_extensions import override

from station.hw.franka.arm.arm_reading import ArmReading
from station.hw.franka.arm.flags import MotionFlags
from station.memory.doubles import doubles
from station.memory.finite_check import FiniteCheck


class Motion(MotionFlags):
    """A motion that waits for its beginning."""

    def __init__(self):
        super().__init__()
        self.waited = []

    @override
    def advance(self, cycles):
        self.waited.append(cycles)


class Arm:
    """Counts how often it is read."""

    def __init__(self):
        self.reads = 0
        self.stops = 0
        self.caught_up = []
        self.readings = doubles([0.0, 0.0])
        self.motion = Motion()
        self.reading = ArmReading(
            self.read,
            FiniteCheck(self.readings),
            self.motion,
            cycle_time=0.001,
            catch_up=self.catch_up,
            end_motion=self.stop,
        )

    def read(self):
        self.reads += 1

    def stop(self):
        self.stops += 1

    def catch_up(self):
        cycles = round(self.reading.time_due / 0.001)
        self.reading.time_due -= cycles * 0.001
        self.caught_up.append(cycles)
        return cycles


@pytest.fixture
def arm():
    return Arm()


def test_the_arm_is_read_once_in_a_cycle_of_its_own_duration(arm):
    for _ in range(3):
        arm.reading.run(0.0, 0.001)
    assert (arm.reads, arm.caught_up) == (3, [])
    assert arm.reading.time_due == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("period", "cycles"), [(0.0, 0), (0.0005, 0), (0.0015, 2)])
def test_any_other_number_of_cycles_is_caught_up_with(arm, period, cycles):
    arm.reading.run(0.0, period)
    assert (arm.reads, arm.caught_up) == (0, [cycles])


def test_a_slow_loop_always_catches_up(arm):
    arm.reading.nominal = 2
    arm.reading.run(0.0, 0.001)
    assert (arm.reads, arm.caught_up) == (0, [1])


def test_a_motion_that_waits_hears_how_many_cycles_have_passed(arm):
    arm.motion.is_waiting = True
    arm.reading.run(0.0, 0.001)
    arm.reading.run(0.0, 0.003)
    assert arm.motion.waited == [1, 3]


def test_a_reading_that_is_not_finite_ends_the_motion_until_it_is_again(arm):
    arm.readings[1] = float("nan")
    arm.reading.run(0.0, 0.001)
    assert (arm.reading.bad, arm.stops) == (1, 1)
    arm.readings[1] = 0.5
    arm.reading.run(0.0, 0.001)
    assert (arm.reading.bad, arm.stops) == (-1, 1)
