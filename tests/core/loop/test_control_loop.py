"""The loop's timing and its promises, on a clock that jumps instead of waiting."""

import sys
import threading

import pytest

from station.core.clock import Clock, ManualClock, SystemClock
from station.core.control.controller_manager import ControllerManager
from station.core.errors import LoopError, StoppedError
from station.core.hardware.interfaces import JointStateHandle, JointStateInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import SLICE, ControlLoop
from station.core.loop.heartbeat import Heartbeat, LoopLife
from station.core.loop.loop_report import LoopState
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters

PERIOD = 0.001


class OneJoint(RobotHW):
    """A joint that counts reads and can be told to fail or to be slow."""

    def __init__(self, clock: ManualClock | None = None) -> None:
        super().__init__()
        self.position = [0.0]
        joints = JointStateInterface()
        joints.register_handle(JointStateHandle("j", self.position, [0.0], [0.0]))
        self.register_interface(joints)
        self.clock = clock
        self.durations: list[float] = []
        self.periods: list[float] = []
        self.fail_in_cycle = 0
        self.error: BaseException = RuntimeError("the cable is out")
        self.cycles_done = threading.Event()
        self.cycles_wanted = 0

    def read(self, time: float, period: float) -> None:
        self.position[0] = time
        self.periods.append(period)
        if len(self.periods) == self.fail_in_cycle:
            raise self.error
        if self.clock is not None and self.durations:
            self.clock.advance(self.durations.pop(0))

    def write(self, time: float, period: float) -> None:
        if len(self.periods) == self.cycles_wanted:
            self.cycles_done.set()


def _loop(hw: OneJoint, clock: Clock | None = None, **options: float) -> ControlLoop:
    clock = clock or ManualClock()
    manager = ControllerManager(hw, Parameters(), [], clock)
    return ControlLoop(hw, manager, clock=clock, period=PERIOD, **options)


def _run_thread(hw: OneJoint, loop: ControlLoop, cycles: int) -> None:
    hw.cycles_wanted = cycles
    loop.start()
    assert hw.cycles_done.wait(5.0)
    loop.stop()


def test_step_runs_exactly_that_many_cycles_with_the_nominal_period():
    hw = OneJoint()
    loop = _loop(hw)
    loop.step(5)
    assert hw.periods == [PERIOD] * 5
    assert loop.time == pytest.approx(5 * PERIOD)
    assert loop.cycle == 5


def test_time_stands_still_while_the_robot_waits(monkeypatch):
    hw = OneJoint()
    monkeypatch.setattr(hw, "longest_period", lambda: 20 * PERIOD)
    loop = _loop(hw)
    for late in (19, 300):
        loop.delay_next_cycle(late)
        loop.step()

    assert hw.periods == pytest.approx([20 * PERIOD] * 2)
    assert loop.time == pytest.approx(40 * PERIOD)


def test_every_cycle_leaves_a_snapshot():
    loop = _loop(OneJoint())
    loop.step(3)
    snapshots, lost = loop.snapshots.read_since(0)
    assert [s.cycle for s in snapshots] == [1, 2, 3]
    assert [s.position for s in snapshots] == [[s.stamp] for s in snapshots]
    assert lost == 0


def test_the_thread_runs_the_same_cycles_as_step():
    hw = OneJoint()
    loop = _loop(hw)
    _run_thread(hw, loop, 20)
    assert hw.periods[:20] == [PERIOD] * 20
    assert loop.report().skipped == 0
    assert loop.state is LoopState.STOPPED


@pytest.mark.parametrize(("slow", "skipped"), [(3, 2), (50, 49)])
def test_a_slow_cycle_is_skipped_over_and_the_period_tells(slow, skipped):
    clock = ManualClock()
    hw = OneJoint(clock)
    hw.durations = [0.0, (slow + 0.5) * PERIOD]
    loop = _loop(hw, clock)
    _run_thread(hw, loop, 10)
    assert hw.periods[:2] == [PERIOD, PERIOD]
    assert hw.periods[2] == pytest.approx((1 + skipped) * PERIOD)
    assert hw.periods[3:10] == [PERIOD] * 7
    assert loop.report().skipped == skipped


def test_real_time_factor_changes_the_wall_rate_only():
    hw = OneJoint()
    clock = ManualClock()
    loop = _loop(hw, clock, real_time_factor=0.5)
    start = clock.now()
    _run_thread(hw, loop, 100)
    elapsed = clock.now() - start
    assert hw.periods[:100] == [PERIOD] * 100
    assert elapsed == pytest.approx(len(hw.periods) * PERIOD / 0.5, rel=1e-5)


def test_an_exception_ends_the_thread_and_is_kept():
    hw = OneJoint()
    hw.fail_in_cycle = 3
    loop = _loop(hw)
    loop.start()
    loop._thread.join(5.0)
    assert loop.state is LoopState.FAILED
    assert loop.failure_summary() == "RuntimeError: the cable is out"
    assert "in read" in loop.report().failure
    with pytest.raises(LoopError, match="the cable is out"):
        loop.run_in_cycle(lambda: None)
    loop.stop()


@pytest.mark.parametrize("error", [SystemExit(3), KeyboardInterrupt()])
def test_no_exception_at_all_leaves_a_dead_loop_that_looks_alive(error):
    hw = OneJoint()
    hw.fail_in_cycle, hw.error = 3, error
    loop = _loop(hw)
    loop.start()
    loop._thread.join(5.0)
    assert loop.state is LoopState.FAILED
    assert type(error).__name__ in loop.failure_summary()
    loop.stop()


def test_an_operation_may_raise_anything_and_the_loop_runs_on():
    loop = _loop(OneJoint(), SystemClock())
    loop.start()
    try:
        with pytest.raises(SystemExit):
            loop.run_in_cycle(lambda: sys.exit(1))
        assert loop.run_in_cycle(lambda: 42) == 42
    finally:
        loop.stop()


def test_whoever_waits_when_the_loop_dies_is_told_at_once():
    hw = OneJoint()
    loop = _loop(hw)
    begun = threading.Event()

    def fail_once_somebody_waits(*_: float) -> None:
        begun.set()
        while not loop._operations:
            pass
        raise RuntimeError("the cable is out")

    hw.write = fail_once_somebody_waits
    loop.start()
    assert begun.wait(5.0)
    with pytest.raises(LoopError, match="the cable is out"):
        loop.run_in_cycle(lambda: None, timeout=60.0)
    loop.stop()


def test_a_loop_that_dies_carries_a_stop_out_and_lists_nothing_as_running():
    hw = OneJoint()
    loop = _loop(hw)
    stopped: list[float] = []
    loop.manager.stop_all = stopped.append

    def fail(*_: float) -> None:
        loop.stop_latch.engage("meanwhile")
        raise RuntimeError("the cable is out")

    hw.write = fail
    loop.start()
    loop._thread.join(5.0)
    assert stopped == [pytest.approx(PERIOD)]
    assert not loop.stop_latch.pending
    assert loop.epoch == 2
    loop.stop()


def test_a_switch_that_comes_after_a_stop_starts_nothing():
    loop = _loop(OneJoint())
    loop.stop_latch.engage("test")
    gate = loop.manager.start_gate
    assert gate is not None
    with pytest.raises(StoppedError):
        gate()


def test_step_is_refused_while_the_thread_runs():
    hw = OneJoint()
    loop = _loop(hw)
    loop.start()
    with pytest.raises(LoopError, match="runs in its thread"):
        loop.step()
    with pytest.raises(LoopError, match="runs already"):
        loop.start()
    loop.stop()


def test_an_operation_runs_in_the_control_thread_and_gives_its_result():
    loop = _loop(OneJoint(), SystemClock())
    loop.start()
    try:
        name = loop.run_in_cycle(lambda: threading.current_thread().name)
        with pytest.raises(ZeroDivisionError):
            loop.run_in_cycle(lambda: 1 // 0)
    finally:
        loop.stop()
    assert name == "control"


def test_an_operation_runs_at_once_when_no_thread_runs():
    assert _loop(OneJoint()).run_in_cycle(lambda: 42) == 42


def test_a_stop_is_carried_out_in_the_next_cycle_and_bumps_the_epoch():
    loop = _loop(OneJoint())
    loop.step()
    loop.stop_latch.engage("test")
    loop.step()
    assert not loop.stop_latch.pending
    assert loop.stop_latch.cycle == 2
    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.snapshots.latest().epoch == 2


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
    loop.pace.paused = paused
    carried_out = threading.Event()
    stopped_at = []

    def stop_all(_: float) -> None:
        stopped_at.append(clock.now())
        carried_out.set()

    manager.stop_all = stop_all
    clock.action = lambda: loop.stop_latch.engage("test")
    loop.start()
    assert carried_out.wait(5.0)
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
            loop.pace.real_time_factor = 100.0

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
    assert first_cycle.wait(5.0)
    loop.stop()

    assert began[0] - start < 0.05


def test_a_real_robot_is_read_once_per_cycle_at_a_slow_rate():
    hw = OneJoint()
    clock = ManualClock()
    manager = ControllerManager(hw, Parameters(), [], clock)
    loop = ControlLoop(hw, manager, clock=clock, period=0.1)
    loop._operations.post(lambda: None)

    _run_thread(hw, loop, 5)

    assert hw.periods[:5] == [0.1] * 5


@pytest.mark.parametrize("paused", [False, True])
def test_every_wake_up_leaves_its_time_in_the_heartbeat(paused):
    clock = SystemClock()
    loop = _loop(OneJoint(), clock)
    loop.pace.paused = paused
    loop.start()
    try:
        for _ in range(3):
            before = clock.now()
            loop.run_in_cycle(lambda: None)
            assert loop.heartbeat.beats[0] > before - 0.5
            assert loop.age() < 5.0
        assert loop.heartbeat.life is LoopLife.RUNNING
    finally:
        loop.stop()
    assert loop.heartbeat.life is LoopLife.STOPPED


def test_a_dead_thread_is_told_in_the_heartbeat():
    hw = OneJoint()
    hw.fail_in_cycle = 3
    loop = _loop(hw)
    loop.start()
    loop._thread.join(5.0)
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
    update = manager.update

    def hang(time: float, period: float, **options: bool) -> None:
        update(time, period, **options)
        heartbeat.ask_stop("the loop hung")

    manager.update = hang
    loop.step()

    assert told == ["stopped", "written"]
    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.stop_latch.reason == "the loop hung"
    assert not heartbeat.is_stop_asked


def test_a_stop_of_the_watchdog_reaches_a_paused_loop():
    hw = OneJoint()
    loop = _loop(hw)
    loop.pace.paused = True
    loop.heartbeat.ask_stop("asked for while paused")
    loop.start()
    while loop.heartbeat.is_stop_asked:
        assert loop.state is LoopState.RUNNING
    loop.stop()

    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.stop_latch.reason == "asked for while paused"
