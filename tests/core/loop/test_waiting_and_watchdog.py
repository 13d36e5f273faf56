"""What the control thread does while it waits, and for a watchdog."""

import sys
import threading

import pytest

from station.core.clock import ManualClock, SystemClock
from station.core.control.controller_manager import ControllerManager
from station.core.loop.control_loop import SLICE, ControlLoop
from station.core.loop.heartbeat import Heartbeat, LoopLife
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters
from station.core.scheduling import CYCLE_SWITCH_INTERVAL, SWITCH_INTERVAL
from station.reports import LoopState
from tests.core.loop.one_joint import PERIOD, OneJoint, make_loop, run_thread
from tests.waiting import PATIENCE


class SteppedClock(ManualClock):
    """A clock whose sleeps are counted, and which does something in one of them."""

    def __init__(self) -> None:
        super().__init__()
        self.longest_sleep = 0.0
        self.action = None
        self.done_at = 0.0

    def sleep_until(self, deadline: float) -> None:
        self.longest_sleep = max(self.longest_sleep, deadline - self.now())
        super().sleep_until(deadline)
        if self.action is not None:
            action, self.action = self.action, None
            self.done_at = self.now()
            action()


@pytest.mark.parametrize("rate", [1000.0, 1.0])
@pytest.mark.parametrize("paused", [False, True])
def test_a_stop_takes_effect_within_10_ms_at_the_smallest_factor(rate, paused):
    clock, hw = SteppedClock(), OneJoint()
    manager = ControllerManager(hw, Parameters(), [], clock)
    loop = ControlLoop(
        hw, manager, clock=clock, period=1.0 / rate, real_time_factor=0.01
    )
    loop.speed.paused = paused
    carried_out = threading.Event()
    stopped_at = []

    def stop_all(_: float) -> None:
        stopped_at.append(clock.now())
        carried_out.set()

    manager.stop_all = stop_all
    clock.action = lambda: loop.stop_latch.engage("test")
    loop.start()
    assert carried_out.wait(PATIENCE)
    loop.stop()

    assert stopped_at[0] - clock.done_at <= 0.01
    assert clock.longest_sleep <= SLICE + 1e-9


def test_an_operation_that_changes_the_factor_ends_the_wait_for_the_old_deadline():
    clock, hw = SteppedClock(), OneJoint()
    manager = ControllerManager(hw, Parameters(), [], clock)
    loop = ControlLoop(hw, manager, clock=clock, period=1.0, real_time_factor=0.01)
    start = clock.now()

    def hasten() -> None:
        def apply() -> None:
            loop.speed.real_time_factor = 100.0

        loop._operations.post(apply)

    first_cycle = threading.Event()
    began = []

    def read(_: float, period: float) -> None:
        if period > 0.0:
            began.append(clock.now())
            first_cycle.set()

    hw.read = read
    clock.action = hasten
    loop.start()
    assert first_cycle.wait(PATIENCE)
    loop.stop()

    assert began[0] - start < 0.05


def test_a_real_robot_is_read_once_per_cycle_at_a_slow_rate():
    hw = OneJoint()
    clock = ManualClock()
    manager = ControllerManager(hw, Parameters(), [], clock)
    loop = ControlLoop(hw, manager, clock=clock, period=0.1)
    loop._operations.post(lambda: None)

    run_thread(hw, loop, 5)

    assert hw.periods[:5] == [0.1] * 5


@pytest.mark.parametrize("paused", [False, True])
def test_every_wake_up_leaves_its_time_in_the_heartbeat(paused):
    clock = SystemClock()
    loop = make_loop(OneJoint(), clock)
    loop.speed.paused = paused
    loop.start()
    try:
        for _ in range(3):
            before = clock.now()
            loop.run_in_cycle(lambda: None)
            assert loop.heartbeat.beats[0] > before - 0.5
            assert loop.age() < PATIENCE
        assert loop.heartbeat.life is LoopLife.RUNNING
    finally:
        loop.stop()
    assert loop.heartbeat.life is LoopLife.STOPPED


def test_a_dead_thread_is_told_in_the_heartbeat():
    hw = OneJoint()
    hw.fail_in_cycle = 3
    loop = make_loop(hw)
    loop.start()
    loop._thread.join(PATIENCE)
    assert loop.heartbeat.life is LoopLife.DIED
    loop.stop()


def test_a_stop_of_the_watchdog_is_carried_out_before_anything_is_written():
    hw, heartbeat = OneJoint(), Heartbeat()
    clock = ManualClock()
    manager = ControllerManager(hw, Parameters(), [], clock)
    loop = ControlLoop(hw, manager, clock=clock, period=PERIOD, heartbeat=heartbeat)
    told = []
    manager.stop_all = lambda _: told.append("stopped")
    hw.write = lambda *_: told.append("written")
    hw.read = lambda *_: heartbeat.ask_stop("the loop hung")
    loop.step()

    assert told == ["stopped", "written"]
    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.stop_latch.reason == "the loop hung"
    assert not heartbeat.is_stop_asked


def test_a_stop_of_the_watchdog_reaches_a_paused_loop():
    hw = OneJoint()
    loop = make_loop(hw)
    loop.speed.paused = True
    loop.heartbeat.ask_stop("asked for while paused")
    loop.start()
    while loop.heartbeat.is_stop_asked:
        assert loop.state is LoopState.RUNNING
    loop.stop()

    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.stop_latch.reason == "asked for while paused"


def test_the_interpreter_is_kept_through_a_cycle_and_given_soon_between_them():
    asleep, awake = [], []

    class Watched(ManualClock):
        def sleep_until(self, deadline: float) -> None:
            asleep.append(sys.getswitchinterval())
            super().sleep_until(deadline)

    class Read(OneJoint):
        def read(self, time: float, period: float) -> None:
            awake.append(sys.getswitchinterval())
            super().read(time, period)

    before = sys.getswitchinterval()
    hw = Read()
    loop = make_loop(hw, Watched())
    run_thread(hw, loop, 3)

    assert asleep == pytest.approx([SWITCH_INTERVAL] * len(asleep))
    assert awake == pytest.approx([CYCLE_SWITCH_INTERVAL] * len(awake))
    assert sys.getswitchinterval() == before
