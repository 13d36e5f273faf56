"""What a whole cycle costs over one step of the simulation, interpreted and compiled.

Run `python benchmarks/bench_cycle.py [--robots panda ur5] [--mode both] [--json]`. One
thread, no deadlines: the loop is stepped. MuJoCo's own step from the same state is
measured in turns with the cycle; low quantiles count, so that the ratio holds on a
machine that is busy with other things as well. Hot: blocks of cycles without a pause.
Cold: single cycles and single steps, each after a sleep of 0.8 ms, as in the live loop.
SCHED_FIFO is used where the system permits it.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator

import mujoco
from cycle_scenarios import CASES, MISSING, SENT, STATES, Case
from measuring import print_table, print_title, simulated_world
from paired_timing import Effort, Turns, ask_for_processor, measure_cold, measure_hot

from station.compiled import SWITCH, status
from station.core.control.switching import SwitchRequest
from station.core.scheduling import realtime_interpreter

MODES = {"interpreted": "0", "compiled": "1"}
SETTLING = 1000
"""Cycles before a measurement."""
QUICK = Effort(blocks=8, calls=200, pairs=60)

Row = dict[str, object]


class Bench:
    """A station, and a copy of its simulated world that is only stepped."""

    def __init__(self, case: Case) -> None:
        self.station = case.make()
        self._robot = case.robot
        self._steer = case.steer
        self._send: Callable[[], None] | None = None
        self._since = 0
        self._world = simulated_world(self.station)
        self._copy = mujoco.MjData(self._world.model)
        self._runs = case.runs
        self._begin()

    def step(self, steps: int) -> None:
        """Make some bare steps of the simulation."""
        model, data = self._world.model, self._copy
        for _ in range(steps):
            mujoco.mj_step(model, data)

    def cycle(self, cycles: int) -> None:
        """Run some cycles, and send set-points if the robot is steered."""
        if self._send is None:
            self.station.loop.step(cycles)
            return
        while cycles:
            if self._since == SENT:
                self._since = 0
                self._send()
            part = min(cycles, SENT - self._since)
            self.station.loop.step(part)
            self._since += part
            cycles -= part

    def rows(self, temperatures: list[str], effort: Effort) -> Iterator[Row]:
        """Measure everything that runs on this robot."""
        for label, names in self._all_runs().items():
            for temperature in temperatures:
                turns = self._measure(names, temperature, effort)
                yield {
                    "robot": self._robot,
                    "controller": label,
                    "mode": status().mode,
                    "temperature": temperature,
                    **turns.row(),
                }

    def _measure(
        self, names: tuple[str, ...], temperature: str, effort: Effort
    ) -> Turns:
        measure = {"hot": measure_hot, "cold": measure_cold}[temperature]
        self.station.simulation.reset()
        if names:
            self.station.switch_controllers(SwitchRequest(start=names))
        self._send = None
        if self._steer is not None:
            self._send = self._steer(self.station, names[0])
        self.cycle(SETTLING)
        result = measure(self.step, self.cycle, self._begin, effort)
        if names:
            self.station.switch_controllers(SwitchRequest(stop=names))
        return result

    def _all_runs(self) -> dict[str, tuple[str, ...]]:
        if self._runs is not None:
            return self._runs
        names = [status.name for status in self.station.controllers()]
        return {"none": (), **{name: (name,) for name in names if name != STATES}}

    def _begin(self) -> None:
        """Put the copy to where the station's world is."""
        mujoco.mj_copyData(self._copy, self._world.model, self._world.data)


def measure_here(
    robots: list[str], temperatures: list[str], effort: Effort
) -> Iterator[Row]:
    """Measure in the mode of this process."""
    ask_for_processor()
    for robot in robots:
        try:
            bench = Bench(CASES[robot])
        except MISSING as error:
            sys.stderr.write(f"{robot} is left out: {error}\n")
            continue
        with realtime_interpreter():
            yield from bench.rows(temperatures, effort)


def measure_both(arguments: list[str], script: str = __file__) -> Iterator[Row]:
    """Measure in a process that runs interpreted, then in one that runs compiled.

    Args:
        arguments: Those of the script, besides `--mode` and `--json`.
        script: The benchmark.
    """
    for mode, switch in MODES.items():
        command = [sys.executable, script, *arguments, "--mode", mode, "--json"]
        environment = {**os.environ, SWITCH: switch}
        result = subprocess.run(
            command, env=environment, stdout=subprocess.PIPE, text=True, check=False
        )
        if result.returncode:
            sys.stderr.write(f"{mode} is left out.\n")
            continue
        yield from json.loads(result.stdout)


def main() -> None:
    """Print the table, or JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--mode", choices=["both", *MODES], default="both")
    parser.add_argument(
        "--temperature", choices=["both", "hot", "cold"], default="both"
    )
    parser.add_argument("--quick", action="store_true", help="measure less")
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    options = parser.parse_args()
    chosen = options.temperature
    temperatures = ["hot", "cold"] if chosen == "both" else [chosen]
    if options.mode == "both":
        arguments = ["--robots", *options.robots, "--temperature", chosen]
        rows = measure_both([*arguments, *(["--quick"] if options.quick else [])])
    else:
        if os.environ.get(SWITCH) != MODES[options.mode]:
            os.environ[SWITCH] = MODES[options.mode]
            os.execv(sys.executable, [sys.executable, *sys.argv])
        effort = QUICK if options.quick else Effort()
        rows = measure_here(options.robots, temperatures, effort)
    found = list(rows)
    if options.json:
        sys.stdout.write(json.dumps(found, indent=1) + "\n")
        return
    print_title("One cycle over one step of the simulation [us], low quantiles")
    headers = list(found[0]) if found else []
    print_table(headers, [list(row.values()) for row in found])


if __name__ == "__main__":
    main()
