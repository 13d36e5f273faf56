"""How late the loop is while an asynchronous controller computes in Python.

Run `python benchmarks/bench_asynchronous.py [--seconds 2] [--turns 10]`. One process, a
live loop of 1 kHz with a simulated Panda. Turns without and with the controller follow
each other in the order A B B A; each update computes for 5 ms, or sleeps for 5 ms.
"""

import argparse
import importlib
import statistics
import sys
from time import perf_counter, sleep

from measuring import print_table, print_title
from typing_extensions import override

from station.app.composition import compose
from station.config import load_config
from station.core.control.controller import Controller
from station.core.control.controller_loader import TableLoader
from station.core.control.switching import Strictness, SwitchRequest
from station.core.facade.station import Station
from station.core.hardware.interfaces import JointStateInterface
from station.core.parameters import Parameters
from station.core.scheduling import realtime_interpreter
from station.reports import Percentiles

CONTROLLER = "effort_group_position_controller"
DURATION = 0.005
"""How long an update takes [s]."""
SETTLING = 0.2
"""How long the loop runs before it is measured [s]."""


class Beside(Controller[JointStateInterface]):
    """Computes, or sleeps, for 5 ms. Its process imports this file as a module."""

    hardware_interface = JointStateInterface
    computes = True

    @override
    def init(self, interface: JointStateInterface, params: Parameters) -> None:
        self.loops = 0

    @override
    def update(self, time: float, period: float) -> None:
        if not self.computes:
            sleep(DURATION)
            return
        end = perf_counter() + DURATION
        while perf_counter() < end:
            self.loops += 1


def measure(
    station: Station, name: str, seconds: float, *, beside: bool
) -> Percentiles:
    """Return the lateness of the loop in a turn."""
    names = (name,)
    start, stop = (names, ()) if beside else ((), names)
    station.switch_controllers(SwitchRequest(start, stop, Strictness.BEST_EFFORT))
    sleep(SETTLING)
    station.loop.reset_statistics()
    sleep(seconds)
    return station.loop.report().lateness


def compare(station: Station, name: str, seconds: float, turns: int) -> list[object]:
    """Return medians of both kinds of turns [us] and their ratio."""
    found: dict[bool, list[float]] = {False: [], True: []}
    for turn in range(turns):
        for beside in (False, True) if turn % 2 == 0 else (True, False):
            report = measure(station, name, seconds, beside=beside)
            found[beside].append(report.p99 * 1e6)
    without, beside_it = (statistics.median(found[one]) for one in (False, True))
    return [without, beside_it, beside_it / without]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--turns", type=int, default=10)
    options = parser.parse_args()
    station = compose(load_config()).station
    # Not the class of `__main__`, which a process could not import.
    kind = importlib.import_module("bench_asynchronous").Beside
    station.manager.register_loader(TableLoader({"bench/Beside": kind}))
    for name in ("thread", "process"):
        how = {"process": name == "process", "time_limit": 5.0}
        shared = {"type": "bench/Beside", "is_async": True}
        station.parameters.set(name, {**shared, "async_parameters": how})
        station.load_controller(name)
    rows = []
    with realtime_interpreter():
        station.loop.start()
        try:
            station.switch_controllers(SwitchRequest(start=(CONTROLLER,)))
            for name in ("process", "thread", "sleeps"):
                kind.computes = name != "sleeps"
                controller = "process" if name == "process" else "thread"
                found = compare(station, controller, options.seconds, options.turns)
                rows.append([name, *found])
        finally:
            station.loop.stop()
    print_title(f"Lateness of the loop, p99 [us], Python {sys.version.split()[0]}")
    print_table(("an update of 5 ms", "without", "with", "ratio"), rows)


if __name__ == "__main__":
    main()
