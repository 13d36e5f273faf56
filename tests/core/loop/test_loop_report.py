"""The loop's measurements on a clock that only moves when told."""

import pytest

from station.core.clock import ManualClock
from station.core.loop.control_loop import LoopMeter
from station.reports import LoopReport, LoopState


def _report(meter: LoopMeter) -> LoopReport:
    return meter.report(
        state=LoopState.RUNNING,
        failure="",
        period=0.001,
        real_time_factor=1.0,
        scheduler="none",
    )


def _run_cycle(meter: LoopMeter, clock: ManualClock, *, skipped: int = 0) -> None:
    meter.woke(0.0002, skipped)
    times = [clock.now()]
    for duration in (0.0001, 0.0003, 0.0002):
        clock.advance(duration)
        times.append(clock.now())
    meter.times.add(*times)


def test_each_part_of_the_cycle_is_measured_on_its_own():
    clock = ManualClock()
    meter = LoopMeter(clock)
    _run_cycle(meter, clock)
    report = _report(meter)
    assert report.read.max == pytest.approx(0.0001, abs=1e-8)
    assert report.update.max == pytest.approx(0.0003, abs=1e-8)
    assert report.write.max == pytest.approx(0.0002, abs=1e-8)
    assert report.total.max == pytest.approx(0.0006, abs=1e-8)
    assert report.lateness.max == pytest.approx(0.0002, abs=1e-8)


def test_skipped_deadlines_lower_the_rate_but_not_the_real_time_factor():
    clock = ManualClock()
    meter = LoopMeter(clock)
    for _ in range(10):
        clock.advance(0.0014)
        _run_cycle(meter, clock, skipped=1)
    report = _report(meter)
    assert report.achieved_rate == pytest.approx(500.0)
    assert report.skipped == 10
    assert report.achieved_real_time_factor == pytest.approx(1.0)


def test_reset_starts_anew():
    clock = ManualClock()
    meter = LoopMeter(clock)
    _run_cycle(meter, clock, skipped=3)
    meter.reset()
    report = _report(meter)
    assert (report.cycles, report.skipped, report.achieved_rate) == (0, 0, 0.0)
