"""The loop's timing and its promises, on a clock that jumps instead of waiting."""

import sys
import threading
from math import inf

import pytest

from station.core.clock import ManualClock, SystemClock
from station.core.errors import LoopError, StoppedError
from station.core.hardware.robot_hw import SimulatedWorld
from station.core.loop.stop_latch import StopState
from station.reports import LoopState
from tests.core.loop.one_joint import PERIOD, OneJoint, make_loop, run_thread
from tests.waiting import PATIENCE


def test_step_runs_exactly_that_many_cycles_with_the_nominal_period():
    hw = OneJoint()
    loop = make_loop(hw)
    loop.step(5)
    assert hw.periods == [PERIOD] * 5
    assert loop.time == pytest.approx(5 * PERIOD)
    assert loop.cycle == 5


class SlowWorld(SimulatedWorld):
    """A world that waits for the loop after 20 periods."""

    def time(self):
        return 0.0

    def reset(self, positions):
        raise AssertionError(positions)

    def longest_period(self):
        return 20 * PERIOD


def test_time_stands_still_while_the_robot_waits(monkeypatch):
    hw = OneJoint()
    world = SlowWorld()
    monkeypatch.setattr(hw, "simulated_world", lambda: world)
    loop = make_loop(hw)
    for late in (19, 300):
        loop.delay_next_cycle(late)
        loop.step()

    assert hw.periods == pytest.approx([20 * PERIOD] * 2)
    assert loop.time == pytest.approx(40 * PERIOD)


def test_every_cycle_leaves_a_snapshot():
    loop = make_loop(OneJoint())
    loop.step(3)
    snapshots, lost = loop.snapshots.read_since(0)
    assert [s.cycle for s in snapshots] == [1, 2, 3]
    assert [s.position for s in snapshots] == [[s.stamp] for s in snapshots]
    assert lost == 0


def test_the_thread_runs_the_same_cycles_as_step():
    hw = OneJoint()
    loop = make_loop(hw)
    run_thread(hw, loop, 20)
    assert hw.periods[:20] == [PERIOD] * 20
    assert loop.report().skipped == 0
    assert loop.state is LoopState.STOPPED


@pytest.mark.parametrize(("slow", "skipped"), [(3, 2), (50, 49)])
def test_a_slow_cycle_is_skipped_over_and_the_period_tells(slow, skipped):
    clock = ManualClock()
    hw = OneJoint(clock)
    hw.durations = [0.0, (slow + 0.5) * PERIOD]
    loop = make_loop(hw, clock)
    run_thread(hw, loop, 10)
    assert hw.periods[:2] == [PERIOD, PERIOD]
    assert hw.periods[2] == pytest.approx((1 + skipped) * PERIOD)
    assert hw.periods[3:10] == [PERIOD] * 7
    assert loop.report().skipped == skipped


def test_real_time_factor_changes_the_wall_rate_only():
    hw = OneJoint()
    clock = ManualClock()
    loop = make_loop(hw, clock, real_time_factor=0.5)
    start = clock.now()
    run_thread(hw, loop, 100)
    elapsed = clock.now() - start
    assert hw.periods[:100] == [PERIOD] * 100
    assert elapsed == pytest.approx(len(hw.periods) * PERIOD / 0.5, rel=1e-5)


def test_an_exception_ends_the_thread_and_is_kept():
    hw = OneJoint()
    hw.fail_in_cycle = 3
    loop = make_loop(hw)
    loop.start()
    loop._thread.join(PATIENCE)
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
    loop = make_loop(hw)
    loop.start()
    loop._thread.join(PATIENCE)
    assert loop.state is LoopState.FAILED
    assert type(error).__name__ in loop.failure_summary()
    loop.stop()


def test_an_operation_may_raise_anything_and_the_loop_runs_on():
    loop = make_loop(OneJoint(), SystemClock())
    loop.start()
    try:
        with pytest.raises(SystemExit):
            loop.run_in_cycle(lambda: sys.exit(1))
        assert loop.run_in_cycle(lambda: 42) == 42
    finally:
        loop.stop()


def test_whoever_waits_when_the_loop_dies_is_told_at_once():
    hw = OneJoint()
    loop = make_loop(hw)
    begun = threading.Event()

    def fail_once_somebody_waits(*_: float) -> None:
        begun.set()
        while not loop._operations:
            pass
        raise RuntimeError("the cable is out")

    hw.write = fail_once_somebody_waits
    loop.start()
    assert begun.wait(PATIENCE)
    with pytest.raises(LoopError, match="the cable is out"):
        loop.run_in_cycle(lambda: None, timeout=60.0)
    loop.stop()


def test_a_loop_that_dies_carries_a_stop_out_and_lists_nothing_as_running():
    hw = OneJoint()
    loop = make_loop(hw)
    stopped: list[float] = []
    loop.manager.stop_all = stopped.append

    def fail(*_: float) -> None:
        loop.stop_latch.engage("meanwhile")
        raise RuntimeError("the cable is out")

    hw.write = fail
    loop.start()
    loop._thread.join(PATIENCE)
    assert stopped == [pytest.approx(PERIOD)]
    assert not loop.stop_latch.pending
    assert loop.epoch == 2
    loop.stop()


def test_a_switch_that_comes_after_a_stop_starts_nothing():
    loop = make_loop(OneJoint())
    loop.stop_latch.engage("test")
    gate = loop.manager.lifecycle.start_gate
    assert gate is not None
    with pytest.raises(StoppedError):
        gate()


@pytest.mark.parametrize(("given", "budget"), [(None, PERIOD), (inf, inf), (0.5, 0.5)])
def test_updates_have_a_budget_of_wall_time_while_the_thread_runs(given, budget):
    hw = OneJoint()
    loop = make_loop(hw, update_budget=given)
    assert loop.manager.controller_update.update_budget == inf
    loop.start()
    while_running = loop.manager.controller_update.update_budget
    loop.stop()
    assert while_running == budget
    assert loop.manager.controller_update.update_budget == inf


def test_step_is_refused_while_the_thread_runs():
    hw = OneJoint()
    loop = make_loop(hw)
    loop.start()
    with pytest.raises(LoopError, match="runs in its thread"):
        loop.step()
    with pytest.raises(LoopError, match="runs already"):
        loop.start()
    loop.stop()


def test_an_operation_runs_in_the_control_thread_and_gives_its_result():
    loop = make_loop(OneJoint(), SystemClock())
    loop.start()
    try:
        name = loop.run_in_cycle(lambda: threading.current_thread().name)
        with pytest.raises(ZeroDivisionError):
            loop.run_in_cycle(lambda: 1 // 0)
    finally:
        loop.stop()
    assert name == "control"


def test_an_operation_runs_at_once_when_no_thread_runs():
    assert make_loop(OneJoint()).run_in_cycle(lambda: 42) == 42


def test_a_stop_is_carried_out_in_the_next_cycle_and_bumps_the_epoch():
    loop = make_loop(OneJoint())
    loop.step()
    loop.stop_latch.engage("test")
    loop.step()
    assert not loop.stop_latch.pending
    assert loop.stop_latch.cycle == 2
    assert loop.stop_latch.state is StopState.STOPPED
    assert loop.snapshots.latest().epoch == 2
