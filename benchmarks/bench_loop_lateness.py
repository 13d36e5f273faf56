"""How late the control thread wakes, and what can be done about it.

Run `python benchmarks/bench_loop_lateness.py [--seconds 5] [--repeats 3]` on a machine
that does nothing else. The real loop runs in its thread with the simulated Panda;
beside it nothing, or a thread that computes in Python. SCHED_FIFO is measured when the
system permits it.
"""

import argparse
import os
import statistics
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from itertools import product
from time import sleep

from bench_interpreter import busy_thread
from measuring import print_table, print_title

from station.app.composition import compose
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.scheduling import SWITCH_INTERVAL, realtime_interpreter
from station.reports import LoopReport

CONTROLLER = "effort_group_position_controller"
SETTLING = 0.5
"""How long the loop runs before it is measured [s]."""


@contextmanager
def running_loop(station: Station, *, fifo: bool) -> Iterator[None]:
    """Run the loop; without `fifo` take back what its thread was granted."""
    station.loop.start()
    try:
        if not fifo:
            control = next(t for t in threading.enumerate() if t.name == "control")
            os.sched_setscheduler(
                control.native_id or 0, os.SCHED_OTHER, os.sched_param(0)
            )
        yield
    finally:
        station.loop.stop()


def measure(
    station: Station, seconds: float, *, busy: bool, interval: float, fifo: bool
) -> LoopReport:
    """Return what the loop says after some seconds."""
    with (
        realtime_interpreter(),
        running_loop(station, fifo=fifo),
        busy_thread() if busy else nullcontext(),
    ):
        sys.setswitchinterval(interval)
        sleep(SETTLING)
        station.loop.reset_statistics()
        sleep(seconds)
        return station.loop.report()


def row(name: str, reports: list[LoopReport]) -> list[object]:
    """Return the medians of some repeats; durations in microseconds."""
    late = [report.lateness for report in reports]
    return [
        name,
        *(
            statistics.median(values) * 1e6
            for values in (
                [one.p50 for one in late],
                [one.p99 for one in late],
                [one.p999 for one in late],
                [one.max for one in late],
            )
        ),
        f"{statistics.median(r.achieved_rate for r in reports):.1f}",
        int(statistics.median(r.skipped for r in reports)),
    ]


def is_fifo_permitted(station: Station) -> bool:
    """Say whether the control thread is granted SCHED_FIFO."""
    with running_loop(station, fifo=True):
        sleep(0.1)
        return station.loop.report().scheduler.startswith("SCHED_FIFO")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    station = compose(load_config()).station
    station.switch_controllers(SwitchRequest(start=(CONTROLLER,)))
    schedulers = {"SCHED_OTHER": False}
    if is_fifo_permitted(station):
        schedulers["SCHED_FIFO"] = True
    rows = []
    for (scheduler, fifo), busy, interval in product(
        schedulers.items(), (False, True), (0.005, SWITCH_INTERVAL)
    ):
        reports = [
            measure(station, options.seconds, busy=busy, interval=interval, fifo=fifo)
            for _ in range(options.repeats)
        ]
        beside = "busy thread" if busy else "idle"
        rows.append(row(f"{beside}, {interval * 1e3:g} ms, {scheduler}", reports))
    print_title(
        f"Lateness of the 1 kHz loop [us], medians of {options.repeats} runs of "
        f"{options.seconds:g} s"
    )
    headers = ("beside, switch interval, scheduler", "p50", "p99", "p99.9", "max")
    print_table((*headers, "rate [Hz]", "skipped"), rows)


if __name__ == "__main__":
    main()
