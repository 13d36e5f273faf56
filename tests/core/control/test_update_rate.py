"""Controllers with a rate of their own: every n-th cycle, and the command between."""

import pytest
from typing_extensions import override

from station.core.control.controller import Controller
from station.core.hardware.interfaces import EffortJointInterface
from station.core.loop.control_loop import ControlLoop
from station.testing.bench import Bench


class Counter(Controller[EffortJointInterface]):
    """Commands the number of its updates, and notes their periods."""

    hardware_interface = EffortJointInterface

    @override
    def init(self, interface, params):
        self.joint = interface.get_handle("j1")
        self.periods, self.times = [], []

    @override
    def update(self, time, period):
        self.periods.append(period)
        self.times.append(time)
        self.joint.set_command(1e-3 * len(self.periods))


def make(update_rate, period=0.001):
    bench = Bench(robot_parameters={"joints": ["j1"]}, period=period)
    counter = bench.load_controller("counter", Counter, update_rate=update_rate)
    bench.switch(start=["counter"])
    return bench, counter


def test_it_is_updated_every_nth_cycle_with_the_period_since_its_last_update():
    bench, counter = make(250)
    first = bench.time + bench.period

    bench.step(12)

    assert counter.times == pytest.approx([first, first + 0.004, first + 0.008])
    # The first period is the nominal one, as in ros2_control.
    assert counter.periods == pytest.approx([0.004, 0.004, 0.004])


def test_its_command_is_kept_in_between_also_if_the_robot_limits_it():
    bench, counter = make(250)
    bench.step(1)
    counter.joint.command_storage[counter.joint.command_index] = 0.0

    bench.step(1)

    assert counter.joint.get_command() == pytest.approx(1e-3)
    assert len(counter.periods) == 1


@pytest.mark.parametrize(
    ("wanted", "possible"),
    # 1000 over round(1000 / wanted), as ros2_control has it.
    [
        (300, 1000 / 3),
        (800, 1000),
        (700, 1000),
        (600, 500),
        (400, 1000 / 3),
        (410, 500),
        (5000, 1000),
    ],
)
def test_an_impossible_rate_becomes_a_possible_one_and_is_told(wanted, possible):
    bench, _ = make(wanted)

    status = bench.status("counter")

    assert status.update_rate == pytest.approx(possible)
    assert f"update_rate of {wanted} Hz" in status.notes[0]


def test_without_a_rate_it_is_updated_in_every_cycle():
    bench, counter = make(0)

    bench.step(5)

    assert len(counter.periods) == 5
    assert bench.status("counter").update_rate == 1000.0
    assert bench.status("counter").notes == ()


def test_a_late_cycle_counts_its_whole_period():
    bench, counter = make(500)
    loop = ControlLoop(bench.robot, bench.manager, clock=bench.clock, period=0.001)
    loop.step(1)
    counter.periods.clear()

    loop.step(1)
    loop.delay_next_cycle(3)
    loop.step(1)

    assert counter.periods == pytest.approx([0.005])
