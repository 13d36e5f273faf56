"""How late the live loop of 1 kHz wakes, beside a bare loop that only sleeps.

Run `python benchmarks/bench_jitter.py [--seconds 5] [--rounds 3] [--json]` on a
machine that does nothing else. The station runs with its default configuration under
the effort group position controller: its loop alone, with the API that nobody reads,
with 10 streams of 100 Hz, with 50, with the dashboard and 5 streams, with 1 and 3
browsers, which are niced, and beside a busy program on every processor; besides, the
loop alone with two arms under the dual-arm impedance controller, and both of these
interpreted. In turns with it runs a bare loop: a process that waits for
absolute deadlines with clock_nanosleep and does nothing else, under the same scheduler,
with the busy programs if there are any. A third process waits in the same way and makes
one `mj_step` of the same robot, with the cold caches that a loop of 1 kHz finds: what a
cycle costs at least. Browsers need Chromium and the packages of the tests.
"""

import argparse
import asyncio
import ctypes
import ctypes.util
import json
import os
import statistics
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from time import CLOCK_MONOTONIC, monotonic_ns, sleep

import mujoco
from bench_cycle import MODES
from cycle_scenarios import CASES, make_dual_panda, make_typical_panda
from live import SETTLING, browsers, read_streams, running_station
from measuring import print_table, print_title, simulated_world

from station import wire
from station.client import StationClient
from station.compiled import SWITCH
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.scheduling import realtime_interpreter, request_realtime_priority
from station.reports import LoopReport

CONTROLLER = "effort_group_position_controller"
DUAL = CASES["dual"].runs["dual-arm impedance"]
PERIOD_NS = 1_000_000
STANDING = 1000
"""Cycles after which a robot stands."""
STANDING_STILL = 50
"""Steps that a robot is left to itself."""
PART_OF_STEPS = 0.25
"""How long steps alone are measured, in windows."""
TIMER_ABSTIME = 1

Lateness = dict[str, float]
"""p50, p99, p999 and max [us], the rate [Hz], p50 and p99 of a whole cycle [us]; or the
p50 of a step alone [us]."""


class Timespec(ctypes.Structure):
    """The time of clock_nanosleep."""

    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


def _wakes(seconds: float) -> Iterator[float]:
    """Wait for the deadlines of a loop; tell how late each one woke [us]."""
    libc = ctypes.CDLL(ctypes.util.find_library("c"))
    request_realtime_priority()
    deadline = monotonic_ns()
    end = deadline + int(seconds * 1e9)
    while deadline < end:
        deadline += PERIOD_NS
        time = Timespec(*divmod(deadline, 1_000_000_000))
        libc.clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, ctypes.byref(time), None)
        late = monotonic_ns() - deadline
        yield late * 1e-3
        deadline += late // PERIOD_NS * PERIOD_NS


def measure_bare(seconds: float) -> Lateness:
    """Return how late a loop wakes that only sleeps."""
    begin = monotonic_ns()
    lateness = list(_wakes(seconds))
    cuts = statistics.quantiles(lateness, n=1000, method="inclusive")
    rate = len(lateness) / (monotonic_ns() - begin) * 1e9
    return _lateness(cuts[499], cuts[989], cuts[998], max(lateness), rate)


def measure_step(seconds: float, make: Callable[[], Station], *run: str) -> Lateness:
    """Return what a step of the simulation costs a loop that does nothing else.

    Args:
        seconds: How long it is measured [s].
        make: Builds the station whose world is stepped.
        run: The controllers that have brought the robot to where it stands.
    """
    station = make()
    station.switch_controllers(SwitchRequest(start=run))
    station.loop.step(STANDING)
    world = simulated_world(station)
    model, data = world.model, mujoco.MjData(world.model)
    costs = []
    for number, _ in enumerate(_wakes(seconds)):
        begin = monotonic_ns()
        mujoco.mj_step(model, data)
        costs.append((monotonic_ns() - begin) * 1e-3)
        if number % STANDING_STILL == 0:  # Nobody controls it: it would fall.
            mujoco.mj_copyData(data, model, world.data)
    return {"step_p50": statistics.median(costs)}


def measure_alone(seconds: float, make: Callable[[], Station], *run: str) -> Lateness:
    """Return how late a station's loop wakes in a process without anything else.

    Args:
        seconds: How long it is measured [s].
        make: Builds the station.
        run: The controllers that run.
    """
    station = make()
    station.switch_controllers(SwitchRequest(start=run))
    with realtime_interpreter():
        station.loop.start()
        sleep(SETTLING)
        station.loop.reset_statistics()
        sleep(seconds)
        report = station.loop.report()
        station.loop.stop()
    return _of_report(report)


def measure_served(streams: int, pages: int | None, seconds: float) -> Lateness:
    """Return how late the loop of a whole station wakes.

    Args:
        streams: How many streams of 100 Hz are read.
        pages: How many browsers look at the dashboard; None: there is no dashboard.
        seconds: How long it is measured [s].
    """
    with ExitStack() as stack:
        has_dashboard = pages is not None
        access = stack.enter_context(running_station(has_dashboard=has_dashboard))
        client = stack.enter_context(StationClient(access["url"], access["token"]))
        client.switch_controllers(start=[CONTROLLER])
        if pages:
            stack.enter_context(browsers(access, pages))
        reset = threading.Timer(SETTLING, client.reset_loop_statistics)
        reset.start()
        if streams:
            whole = SETTLING + seconds
            asyncio.run(read_streams(access["url"], access["token"], streams, whole))
        else:
            sleep(SETTLING + seconds)
        reset.join()
        return _of_report(client.loop())


@contextmanager
def busy_programs() -> Iterator[None]:
    """Let a program compute on every processor."""
    command = [sys.executable, "-c", "while True: sum(range(1000))"]
    count = len(os.sched_getaffinity(0))
    programs = [subprocess.Popen(command) for _ in range(count)]
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


@dataclass(frozen=True, slots=True)
class Condition:
    """What goes on beside the loop.

    Attributes:
        name: How the table calls it.
        measure: Measures the station's loop for some seconds.
        is_busy: Whether other programs compute.
        step: The process that makes steps of the same robot alone.
    """

    name: str
    measure: Callable[[float], Lateness]
    is_busy: bool = False
    step: str = "step"


def _in_process(kind: str, mode: str = "compiled") -> Callable[[float], Lateness]:
    """Return what measures in a process of its own, in one of the modes."""
    environment = {**os.environ, SWITCH: MODES[mode]}

    def measure(seconds: float) -> Lateness:
        command = [sys.executable, __file__, "--only", kind, "--seconds", str(seconds)]
        done = subprocess.run(
            command, env=environment, stdout=subprocess.PIPE, check=True
        )
        return json.loads(done.stdout)

    return measure


def _served(streams: int, pages: int | None) -> Callable[[float], Lateness]:
    return lambda seconds: measure_served(streams, pages, seconds)


CONDITIONS = {
    "alone": Condition("loop alone", _in_process("alone")),
    "dual": Condition(
        "loop alone, 2 arms under impedance", _in_process("dual"), step="dual step"
    ),
    "interpreted": Condition(
        "loop alone, interpreted", _in_process("alone", "interpreted")
    ),
    "dual-interpreted": Condition(
        "loop alone, 2 arms under impedance, interpreted",
        _in_process("dual", "interpreted"),
        step="dual step",
    ),
    "api": Condition("API", _served(0, None)),
    "streams10": Condition("API, 10 streams of 100 Hz", _served(10, None)),
    "streams50": Condition("API, 50 streams of 100 Hz", _served(50, None)),
    "dashboard": Condition(
        "dashboard without browsers, 5 streams of 100 Hz", _served(5, 0)
    ),
    "busy": Condition("API, busy neighbours", _served(0, None), is_busy=True),
    # Last: this process is as nice as they are afterwards.
    "browser1": Condition("dashboard, 1 browser", _served(0, 1)),
    "browser3": Condition("dashboard, 3 browsers", _served(0, 3)),
}


def measure_row(condition: Condition, rounds: int, seconds: float) -> dict[str, object]:
    """Return a row of the table: the medians of some rounds of both loops in turns."""
    bare, live, step = [], [], []
    measure_bare_loop = _in_process("bare")
    measure_step_alone = _in_process(condition.step)
    for _ in range(rounds):
        with ExitStack() as stack:
            if condition.is_busy:
                stack.enter_context(busy_programs())
            bare.append(measure_bare_loop(seconds))
            live.append(condition.measure(seconds))
            step.append(measure_step_alone(PART_OF_STEPS * seconds))

    def median(found: list[Lateness], key: str) -> float:
        return round(statistics.median(one[key] for one in found), 2)

    return {
        "beside": condition.name,
        **{f"{key}_us": median(live, key) for key in ("p50", "p99", "p999", "max")},
        "rate_hz": median(live, "rate"),
        "cycle_p50_us": median(live, "cycle_p50"),
        "cycle_p99_us": median(live, "cycle_p99"),
        "step_p50_us": median(step, "step_p50"),
        "cycle_over_step": round(
            statistics.median(
                cycle["cycle_p50"] / alone["step_p50"]
                for cycle, alone in zip(live, step, strict=True)
            ),
            2,
        ),
        "bare_p50_us": median(bare, "p50"),
        "bare_p99_us": median(bare, "p99"),
        "bare_max_us": median(bare, "max"),
        "p99_over_bare": round(median(live, "p99") / median(bare, "p99"), 2),
    }


PROCESSES: dict[str, Callable[[float], Lateness]] = {
    "bare": measure_bare,
    "alone": lambda seconds: measure_alone(seconds, make_typical_panda, CONTROLLER),
    "dual": lambda seconds: measure_alone(seconds, make_dual_panda, *DUAL),
    "step": lambda seconds: measure_step(seconds, make_typical_panda, CONTROLLER),
    "dual step": lambda seconds: measure_step(seconds, make_dual_panda, *DUAL),
}
"""What is measured in a process of its own."""


def _of_report(report: LoopReport | wire.LoopReport) -> Lateness:
    late, total = report.lateness, report.total
    seconds = (late.p50, late.p99, late.p999, late.max)
    return {
        **_lateness(*(value * 1e6 for value in seconds), report.achieved_rate),
        "cycle_p50": total.p50 * 1e6,
        "cycle_p99": total.p99 * 1e6,
    }


def _lateness(
    p50: float, p99: float, p999: float, highest: float, rate: float
) -> Lateness:
    return {"p50": p50, "p99": p99, "p999": p999, "max": highest, "rate": rate}


def main() -> None:
    """Print the table, or JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0, help="of each window")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--beside", nargs="+", choices=CONDITIONS, default=CONDITIONS)
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    parser.add_argument("--only", choices=PROCESSES, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.only:
        sys.stdout.write(json.dumps(PROCESSES[options.only](options.seconds)))
        return
    rows = []
    for name in options.beside:
        try:
            rows.append(measure_row(CONDITIONS[name], options.rounds, options.seconds))
        except (ImportError, FileNotFoundError) as error:
            sys.stderr.write(f"{CONDITIONS[name].name} is left out: {error}\n")
    if options.json:
        sys.stdout.write(json.dumps(rows, indent=1) + "\n")
        return
    print_title(
        f"Lateness of the live loop [us], medians of {options.rounds} windows of "
        f"{options.seconds:g} s"
    )
    print_table(list(rows[0]), [list(row.values()) for row in rows])


if __name__ == "__main__":
    main()
