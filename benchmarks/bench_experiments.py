"""What experiments cost and find: the robustness table, efficiency, memory.

Run `python benchmarks/bench_experiments.py [PART …] [--trials N]`; the parts:

- `robustness`: the default effort trajectory controller under loads of 0 to 3 kg,
  friction of 0.25 to 0.75 Nm and delays of 0 to 3 cycles, 500 trials of 2 s; the
  worst trial is played again from its hash. docs/experiments.md has the RMS error.
- `efficiency`: trials per second on two processes over one, in runs that take turns.
- `cluster`: trials per second on four Dask workers over those on two processes, all of
  the same low priority, with what docs/experiments.md tells Dask for few cores; about a
  minute. `DASK_…` variables of the caller come before it.
- `cost`: wall and processor time of one trial of 2 s of the default effort trajectory
  controller, one after the other, and what a million of them cost. docs/experiments.md
  has it.
- `memory`: the memory of a process that runs 10,000 trials of 20 ms.
"""

import argparse
import gc
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from measuring import print_table, print_title

from station.experiments.designs import parse_range, points
from station.experiments.experiment import ROBUSTNESS_RANGES, sweep
from station.experiments.pools import NICENESS, be_polite, make_pool
from station.experiments.trial_world import TrialWorld, default_script
from station.trials.analysis import ranked, summary
from station.trials.results import Results
from station.trials.trial import Script, Setup, Trial
from station.wire.excitations import Step

CONTROLLER = "effort_joint_trajectory_controller"
GROUP = "effort_group_position_controller"
QUIET_DASK = {
    "distributed": {
        "admin": {"tick": {"interval": "1s"}},
        "worker": {"profile": {"enabled": False}},
    }
}
"""By default, each process of Dask looks fifty times a second whether its loop is in
time, and a hundred times what it runs: 27 % of a core for four workers that do nothing,
8 % with this."""
SEED = 1
ROUNDS = 3


def short(setup: Setup, duration: float) -> Trial:
    """Return a trial with a step of joint 1 in the effort group controller."""
    motion = Step(joint="panda_joint1", amplitude=0.1)
    return Trial(setup, Script(controller=GROUP, duration=duration, commands=(motion,)))


def robustness(trials: int, folder: Path) -> None:
    """Print the distribution of each metric, and play the worst trial again."""
    setup = Setup.load()
    with TrialWorld(setup) as world:
        base = Trial(setup, default_script(world, CONTROLLER))
    ranges = [parse_range(text) for text in ROBUSTNESS_RANGES]
    places = points(ranges, "random", trials, SEED)
    with (
        Results.create(
            folder / "robustness.sqlite", "robustness", setup, {}
        ) as results,
        make_pool() as pool,
    ):
        sweep(base, places, results, pool, has_seeds=True)
        print_title(f"{trials} trials of {CONTROLLER}: {', '.join(ROBUSTNESS_RANGES)}")
        print_table(
            ["metric", "5 %", "median", "95 %", "worst"],
            [[d.metric, d.p5, d.median, d.p95, d.worst] for d in summary(results)],
        )
        failed = sum(row.result.state == "failed" for row in results.rows())
        worst = ranked(results, "rms_error")[-1]
        with TrialWorld(setup) as world:
            again = world.run(results.trial(worst.result.hash))
        same = "the same" if again.metrics == worst.result.metrics else "OTHER"
        shown = ", ".join(f"{k} {v:.3g}" for k, v in worst.parameters.items())
        sys.stdout.write(
            f"{failed} failed. The worst, {worst.result.hash}: {shown}; played again "
            f"from its hash it gives {same} numbers.\n"
        )


def efficiency(trials: int, folder: Path) -> None:
    """Print trials per second of one and two processes, in turns."""
    setup = Setup.load()
    base = short(setup, 1.0)
    rates: dict[int, list[float]] = {1: [], 2: []}
    for turn in range(ROUNDS):
        for workers in (1, 2):
            rates[workers].append(_rate(base, trials, workers, folder / f"{turn}"))
    ratios = [two / one for one, two in zip(rates[1], rates[2], strict=True)]
    print_title(f"{trials} trials of 1 s, {ROUNDS} turns")
    print_table(
        ["processes", "trials per s"],
        [[workers, statistics.median(found)] for workers, found in rates.items()],
    )
    sys.stdout.write(f"two over one: {statistics.median(ratios):.2f} (median)\n")


def cluster(trials: int, folder: Path) -> None:
    """Print trials per second of four Dask workers over two processes, in turns."""
    import dask
    from distributed import LocalCluster

    from station.experiments.cluster import ClusterExecutor

    # Processes of the pool have a low priority; workers of Dask inherit this one's.
    be_polite(NICENESS)
    setup = Setup.load()
    base = short(setup, 1.0)
    rates: dict[str, list[float]] = {"2 processes": [], "4 Dask workers": []}
    dask.config.update_defaults(QUIET_DASK)
    with LocalCluster(
        n_workers=4, threads_per_worker=1, dashboard_address=None
    ) as local:
        for turn in range(ROUNDS):
            with make_pool(2) as pool:
                rate = _rate_on(base, trials, pool, folder / f"{turn}-pool.sqlite")
            rates["2 processes"].append(rate)
            with ClusterExecutor(local.scheduler_address, setup.text) as workers:
                rate = _rate_on(base, trials, workers, folder / f"{turn}-dask.sqlite")
            rates["4 Dask workers"].append(rate)
    ratios = [b / a for a, b in zip(*rates.values(), strict=True)]
    print_title(f"{trials} trials of 1 s, {ROUNDS} turns")
    print_table(
        ["where", "trials per s"],
        [[where, statistics.median(found)] for where, found in rates.items()],
    )
    sys.stdout.write(f"Dask over processes: {statistics.median(ratios):.2f} (median)\n")


def _rate(base: Trial, trials: int, workers: int, folder: Path) -> float:
    """Return trials per second of so many processes."""
    with make_pool(workers) as pool:
        return _rate_on(base, trials, pool, folder / f"{workers}.sqlite")


def _rate_on(base: Trial, trials: int, executor: Executor, path: Path) -> float:
    """Return trials per second once every process has built its world."""
    with Results.create(path, "sweep", base.setup, {}) as results:
        sweep(base, _loads(16), results, executor)
        begin = time.perf_counter()
        sweep(base, _loads(trials, first=1.0), results, executor)
        return trials / (time.perf_counter() - begin)


def _loads(count: int, first: float = 0.0) -> Sequence[dict[str, float]]:
    return [{"load": first + number / (2.0 * count)} for number in range(count)]


def cost(trials: int, folder: Path) -> None:
    """Print what a default trial takes, and what a million of them take."""
    del folder  # no results are kept
    setup = Setup.load()
    with TrialWorld(setup) as world:
        base = Trial(setup, default_script(world, CONTROLLER))
        world.run(base)  # the first one touches memory for the first time
        begin_cpu = time.process_time()
        found = [
            world.run(base.with_parameters({"load": n / trials})).seconds
            for n in range(trials)
        ]
        used = (time.process_time() - begin_cpu) / trials
    median = statistics.median(found)
    fifth, *_, last = statistics.quantiles(found, n=20)
    print_title(f"{trials} trials of 2 s of {CONTROLLER}, one after the other")
    print_table(
        ["median [s]", "5 % [s]", "95 % [s]", "processor [s]"],
        [[median, fifth, last, used]],
    )
    # Processor time, because others may have used the cores at the same time.
    hours = used * 1e6 / 3600.0
    sys.stdout.write(
        f"A million trials: {hours:.0f} hours of one core to itself, or "
        f"{hours / 100.0:.2f} hours of 100 such cores.\n"
    )


def memory(trials: int, folder: Path) -> None:
    """Print the memory of a process as its trials go by."""
    setup = Setup.load()
    base = short(setup, 0.02)
    rows: list[list[object]] = []
    with (
        Results.create(folder / "memory.sqlite", "sweep", setup, {}) as results,
        TrialWorld(setup) as world,
    ):
        for number in range(trials + 1):
            if number % max(1, trials // 5) == 0:
                gc.collect()
                rows.append([number, _resident()])
            trial = base.with_parameters({"load": number / trials}, number)
            results.add(trial, world.run(trial))
    print_title("Memory of a process that runs trials of 20 ms")
    print_table(["trials", "MB"], rows)


def _resident() -> float:
    """Return the memory of this process that is in use [MB]."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    (line,) = [line for line in status.splitlines() if line.startswith("VmRSS:")]
    return float(line.split()[1]) / 1024.0


PARTS = {
    "robustness": (robustness, 500),
    "efficiency": (efficiency, 200),
    "cluster": (cluster, 400),
    "cost": (cost, 40),
    "memory": (memory, 10_000),
}


def main() -> None:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--trials", type=int, help="instead of the usual number")
    options = parser.parse_args()
    for name in options.parts or PARTS:
        run, usual = PARTS[name]
        with tempfile.TemporaryDirectory() as folder:
            run(options.trials or usual, Path(folder))


if __name__ == "__main__":
    main()
