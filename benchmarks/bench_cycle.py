"""What a cycle costs: the simulated Franka, and each controller of the configuration.

Run `python benchmarks/bench_cycle.py`. One thread, no deadlines: the loop is stepped.
MuJoCo's own step of the same arm is measured in turns with the cycle, so that the
ratio holds on a machine that is busy with other things as well.
"""

import statistics
from time import perf_counter

import mujoco
from measuring import print_table, print_title, simulated_world

from station.app.composition import compose
from station.config import load_config
from station.core.control.switching import SwitchRequest

CYCLES = 1000
BLOCKS = 15


class Bench:
    """The station of the default configuration, and a copy of its simulated state."""

    def __init__(self) -> None:
        self.station = compose(load_config()).station
        self.loop = self.station.loop
        world = simulated_world(self.station)
        self.model = world.model
        self.data = mujoco.MjData(world.model)
        mujoco.mj_copyData(self.data, world.model, world.data)

    def time_steps(self) -> float:
        """Return how long one `mj_step` takes [us]."""
        begin = perf_counter()
        for _ in range(CYCLES):
            mujoco.mj_step(self.model, self.data)
        return (perf_counter() - begin) / CYCLES * 1e6

    def time_cycles(self) -> float:
        """Return how long one whole cycle of the loop takes [us]."""
        begin = perf_counter()
        self.loop.step(CYCLES)
        return (perf_counter() - begin) / CYCLES * 1e6

    def time_phases(self) -> tuple[float, float, float]:
        """Return the medians of read, update and write [us]."""
        self.loop.reset_statistics()
        self.loop.step(CYCLES)
        report = self.loop.report()
        read, update, write = report.read.p50, report.update.p50, report.write.p50
        return read * 1e6, update * 1e6, write * 1e6

    def measure(self, controller: str) -> list[object]:
        """Return a row of the table."""
        names = [controller] if controller else []
        if names:
            self.station.switch_controllers(SwitchRequest(start=tuple(names)))
        self.loop.step(CYCLES)
        pairs = [(self.time_steps(), self.time_cycles()) for _ in range(BLOCKS)]
        phases = self.time_phases()
        if names:
            self.station.switch_controllers(SwitchRequest(stop=tuple(names)))
        step = statistics.median(step for step, _ in pairs)
        cycle = statistics.median(cycle for _, cycle in pairs)
        ratio = statistics.median(cycle / step for step, cycle in pairs)
        return [controller or "none", step, *phases, cycle, ratio]


def main() -> None:
    """Print the table."""
    bench = Bench()
    names = [status.name for status in bench.station.controllers()]
    print_title(f"One cycle of the simulated Panda [us], medians of {BLOCKS} blocks")
    print_table(
        ("controller", "mj_step", "read", "update", "write", "cycle", "cycle/mj_step"),
        [bench.measure(name) for name in ("", *names)],
    )


if __name__ == "__main__":
    main()
