"""How late the loop is while motions are rehearsed beside it.

Run `python benchmarks/bench_rehearsal.py [--seconds 6] [--turns 3]`. One process: a
live loop of 1 kHz with a simulated Panda that holds its pose. Turns without and with
rehearsals follow each other in the order A B B A; one of 2 s is made each second.
"""

import argparse
import statistics
from time import perf_counter, sleep

from measuring import print_table, print_title

from station.app.composition import compose
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.scheduling import realtime_interpreter
from station.rehearsal.rehearsals import Rehearsals

CONTROLLER = "effort_group_position_controller"
MOTION = 2.0
"""What is rehearsed [s of the robot]."""
EVERY = 1.0
"""Time between two rehearsals [s]."""


def turn(
    station: Station, rehearsals: Rehearsals | None, seconds: float
) -> list[float]:
    """Return lateness p99 and p99.9 [us], cycles left out, and ms a rehearsal."""
    station.loop.reset_statistics()
    took = [0.0]
    end = perf_counter() + seconds
    while perf_counter() < end:
        if rehearsals is not None:
            took.append(rehearsals.rehearse([], MOTION).wall_time)
        sleep(EVERY - took[-1])
    report = station.loop.report()
    late = report.lateness
    longest = statistics.median(took[1:] or took)
    return [late.p99 * 1e6, late.p999 * 1e6, report.skipped, longest * 1e3]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=6.0)
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    station = compose(load_config()).station
    found: dict[bool, list[list[float]]] = {False: [], True: []}
    rehearsals = Rehearsals(station)
    with realtime_interpreter():
        station.loop.start()
        try:
            station.switch_controllers(SwitchRequest(start=(CONTROLLER,)))
            rehearsals.rehearse([], EVERY)
            sleep(EVERY)
            for number in range(options.turns):
                for beside in (False, True) if number % 2 == 0 else (True, False):
                    used = rehearsals if beside else None
                    found[beside].append(turn(station, used, options.seconds))
        finally:
            station.loop.stop()
    rows: list[list[object]] = []
    for beside, turns in found.items():
        medians = [statistics.median(one) for one in zip(*turns, strict=True)]
        rows.append(["with rehearsals" if beside else "without", *medians])
    print_title("Lateness of the loop beside rehearsals, medians of the turns")
    print_table(
        ("", "p99 [us]", "p99.9 [us]", "cycles left out", "a rehearsal [ms]"), rows
    )


if __name__ == "__main__":
    main()
