"""How many trials a processor makes in a second: a reset, and a second of motion each.

Run `python benchmarks/bench_batch.py [--seconds 5] [--json]`. A trial resets the world,
starts the effort group position controller and steps 1000 cycles towards a step of
0.3 rad; docs/experiments.md has such a program. One station, and 8 stations that take
turns in one process; interpreted and compiled. Processor time counts, so that a busy
machine hardly matters.
"""

import argparse
import itertools
import json
import os
import resource
import subprocess
import sys
from collections.abc import Iterator
from time import process_time

from measuring import print_table, print_title

from station.app.composition import compose
from station.compiled import SWITCH, status
from station.config import load_config
from station.core import SnapshotRing, SwitchRequest
from station.core.facade.station import Station

CONTROLLER = "effort_group_position_controller"
TARGET = [0.3, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
CYCLES = 1000
COUNTS = (1, 8)
MODES = {"interpreted": "0", "compiled": "1"}


def make_station() -> Station:
    """Return a station of the default configuration that keeps few snapshots."""
    return compose(load_config(), snapshots=SnapshotRing(16)).station


def run_trial(station: Station) -> None:
    """Reset the world and let the arm make a step."""
    station.simulation.reset()
    station.switch_controllers(SwitchRequest(start=(CONTROLLER,)))
    station.motion.set_command(CONTROLLER, TARGET)
    station.loop.step(CYCLES)
    station.switch_controllers(SwitchRequest(stop=(CONTROLLER,)))


def measure(count: int, seconds: float) -> dict[str, object]:
    """Return the row of some stations that take turns.

    Args:
        count: How many stations.
        seconds: For how long trials begin [s of processor time].
    """
    before = _memory()
    begin = process_time()
    stations = [make_station() for _ in range(count)]
    building = (process_time() - begin) / count
    memory = (_memory() - before) / count
    for station in stations:
        run_trial(station)
    trials = 0
    begin = process_time()
    for station in itertools.cycle(stations):
        run_trial(station)
        trials += 1
        if (elapsed := process_time() - begin) >= seconds:
            break
    return {
        "stations": count,
        "mode": status().mode,
        "trials_per_s": round(trials / elapsed, 2),
        "cycles_per_s": round(trials * CYCLES / elapsed),
        "times_real_time": round(trials * CYCLES / elapsed / 1000.0, 1),
        "build_s": round(building, 2),
        "memory_mb": round(memory, 1),
    }


def measure_both(seconds: float) -> Iterator[dict[str, object]]:
    """Measure each row in a process of its own."""
    for (mode, switch), count in itertools.product(MODES.items(), COUNTS):
        command = [sys.executable, __file__, "--seconds", str(seconds)]
        result = subprocess.run(
            [*command, "--stations", str(count)],
            env={**os.environ, SWITCH: switch},
            stdout=subprocess.PIPE,
            text=True,
            check=False,
        )
        if result.returncode:
            sys.stderr.write(f"{mode} is left out.\n")
            continue
        yield json.loads(result.stdout)


def _memory() -> float:
    """Return the most memory that the process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    """Print the table, or JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--stations", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    options = parser.parse_args()
    if options.stations:
        sys.stdout.write(json.dumps(measure(options.stations, options.seconds)))
        return
    rows = list(measure_both(options.seconds))
    if options.json:
        sys.stdout.write(json.dumps(rows, indent=1) + "\n")
        return
    print_title(f"Trials of {CYCLES} cycles per second and processor")
    print_table(list(rows[0]), [list(row.values()) for row in rows])


if __name__ == "__main__":
    main()
