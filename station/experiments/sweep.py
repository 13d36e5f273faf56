"""Many trials that differ in their parameters: sweeps, and Monte Carlo robustness."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor

from station.experiments.runner import Progress, Runner, Watcher
from station.experiments.trial_world import TrialWorld
from station.trials.analysis import ranked
from station.trials.results import Results
from station.trials.trial import Trial

ROBUSTNESS_RANGES = ("load=0:3", "friction=0.25:0.75", "delay=0:3")
"""What a robot may meet: a load that nobody told it of, friction of 0.5 Nm give or take
half of it, and up to three cycles of delay."""


def sweep(
    base: Trial,
    points: Sequence[Mapping[str, float]],
    results: Results,
    executor: Executor,
    watch: Watcher = lambda _: None,
    *,
    has_seeds: bool = False,
) -> Progress:
    """Run a trial for every point.

    Args:
        base: The trial that the points change.
        points: Parameters of each trial.
        results: Where the trials are kept.
        executor: Where they run.
        watch: Is told after every trial.
        has_seeds: Whether each trial has measurement noise of its own: its seed is
            then that of `base` plus its number.

    Raises:
        ExperimentError: Workers die or refuse again and again; what has ended is kept.
    """
    trials = (
        base.with_parameters(point, base.seed + number if has_seeds else None)
        for number, point in enumerate(points)
    )
    return Runner(results, executor, watch).run(trials, len(points))


def keep_worst(results: Results, metric: str, count: int) -> list[str]:
    """Play the worst trials again and keep their recordings; return their hashes.

    A trial gives the same numbers every time, so that nothing has to be recorded before
    it is known which trials are the worst. Trials that have failed are the worst of
    all.

    Args:
        results: The experiment.
        metric: What decides.
        count: How many trials, >= 0.

    Raises:
        ExperimentError: Trials are done, but none has the metric.
    """
    failed = [r.result.hash for r in results.rows() if r.result.state == "failed"]
    done = ranked(results, metric) if results.count("done") else []
    worst = [row.result.hash for row in reversed(done)]
    chosen = [*failed, *worst][:count]
    with TrialWorld(results.setup) as world:
        for name in chosen:
            _, trace = world.record(results.trial(name))
            if trace is not None:
                results.keep_recording(name, trace)
    return chosen
