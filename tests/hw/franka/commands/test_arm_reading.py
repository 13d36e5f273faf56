"""How often an arm is read in a cycle of the loop, and what follows."""

from math import inf, nan

import pytest

from station.core.franka.franka_robot_state import MODE
from station.hw.franka.commands.arm_reading import ArmReading
from tests.hw.franka.commands.test_command_sender import VELOCITIES, Bench

PERIOD = 0.001


class Motion:
    """A motion that may wait for its beginning."""

    def __init__(self):
        self.waited = []

    def advance(self, cycles):
        self.waited.append(cycles)


class Read(Bench):
    """An arm that counts how often it is read; its motion has begun."""

    def __init__(self, *, rate_limiting=True):
        super().__init__(*VELOCITIES, rate_limiting=rate_limiting)
        self.motion = Motion()
        self.reading = ArmReading(
            self.arm, self.motion, self.sender, most_lost=20, losses_that_end=20
        )
        self.start = self.arm.state.time

    @property
    def reads(self):
        return round((self.arm.state.time - self.start) / PERIOD)


@pytest.fixture
def arm():
    return Read()


def test_the_arm_is_read_once_in_a_cycle_of_its_own_duration(arm):
    for _ in range(3):
        arm.reading.read(0.0, PERIOD)
    assert (arm.reads, arm.arm.sent) == (3, [])
    assert arm.reading.time_due == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("period", "cycles"), [(0.0, 0), (0.0004, 0), (0.0016, 2)])
def test_any_other_number_of_cycles_is_read_as_well(arm, period, cycles):
    arm.reading.read(0.0, period)
    assert arm.reads == cycles
    assert arm.reading.time_due == pytest.approx(period - cycles * PERIOD)


@pytest.mark.parametrize(("rate_limiting", "sent"), [(True, 3), (False, 0)])
def test_a_slow_loop_sends_its_command_again_in_the_cycles_between(rate_limiting, sent):
    arm = Read(rate_limiting=rate_limiting)
    arm.reading.nominal = 4
    arm.reading.read(0.0, 4 * PERIOD)
    assert (arm.reads, len(arm.arm.sent)) == (4, sent)


def test_the_cycles_of_a_late_loop_are_lost(arm):
    arm.reading.read(0.0, 5 * PERIOD)
    assert (arm.reads, arm.arm.sent) == (5, [])


def test_a_very_late_loop_loses_twenty_cycles_and_no_more(arm):
    arm.reading.read(0.0, 50 * PERIOD)
    assert arm.reads == 21
    arm.reading.read(0.0, PERIOD)
    assert arm.reads == 22


def test_a_motion_that_waits_hears_how_many_cycles_have_passed(arm):
    arm.sender.is_waiting = True
    arm.reading.read(0.0, PERIOD)
    arm.reading.read(0.0, 3 * PERIOD)
    assert arm.motion.waited == [1, 3]


@pytest.mark.parametrize(
    ("field", "joint", "value", "text"),
    [
        ("q", 2, nan, "the position of joint2 reads nan"),
        ("dtheta", 7, inf, None),
        ("tau_J", 1, -inf, "the torque of joint1 reads -inf"),
    ],
)
def test_a_reading_that_is_not_finite_is_named_and_ends_the_motion(
    arm, field, joint, value, text
):
    arm.arm.state.doubles(field)[joint - 1] = value
    arm.reading.read(0.0, PERIOD)
    assert arm.reading.blindness() == text
    assert (arm.arm.state.doubles(MODE)[0] == 2) is (text is None)
    arm.arm.state.doubles(field)[joint - 1] = 0.5
    arm.reading.read(0.0, PERIOD)
    assert arm.reading.blindness() is None


def test_an_arm_is_interrupted_when_it_has_left_a_motion_that_has_begun():
    arm = Read()
    sender, code = arm.sender, arm.arm.state.doubles(MODE)
    sender.is_active = True
    assert (sender.is_interrupted(), sender.mode_name()) == (False, "move")
    code[0] = 1.0
    assert (sender.is_interrupted(), sender.mode_name()) == (True, "idle")
    sender.is_waiting = True
    assert not sender.is_interrupted()
