"""Search for better gains with CMA-ES, beginning at the present ones."""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field

from station.core.errors import suggest
from station.experiments.errors import (
    ExperimentError,
    ImpossibleRangeError,
    UnknownParameterError,
)
from station.experiments.metrics import LARGER_IS_BETTER, UNITS
from station.experiments.results import Results
from station.experiments.runner import Progress, Runner, Watcher
from station.experiments.trial import Trial, TrialResult

_FAILED = 1e6
"""Cost of a trial that failed."""
_VIOLATED = 1e3
"""Cost of a trial that violates a constraint, before the excess is added."""


def check_metric(name: str) -> None:
    """Refuse a metric that there is not.

    Raises:
        UnknownParameterError: There is no such metric.
    """
    if name not in UNITS:
        raise UnknownParameterError(
            f"There is no metric '{name}'.", remedy=suggest(name, UNITS)
        )


@dataclass(frozen=True, slots=True)
class Bound:
    """A hard constraint: a metric is at most a number, or a multiple of the first.

    Args:
        metric: The metric.
        limit: The number, finite.
        is_relative: Whether `limit` is a multiple of the metric of the first trial.

    Raises:
        UnknownParameterError: There is no such metric.
        ImpossibleRangeError: The limit is not finite.
    """

    metric: str
    limit: float
    is_relative: bool = False

    def __post_init__(self) -> None:
        check_metric(self.metric)
        if not math.isfinite(self.limit):
            raise ImpossibleRangeError(
                f"The bound of '{self.metric}' is {self.limit}; allowed are finite "
                "numbers."
            )

    def excess(self, metrics: Mapping[str, float], first: Mapping[str, float]) -> float:
        """Return by which share the bound is exceeded; 0 when it is kept."""
        limit = self.limit * first[self.metric] if self.is_relative else self.limit
        over = metrics.get(self.metric, math.inf) - limit
        return max(0.0, over / max(abs(limit), 1e-9))


@dataclass(frozen=True, slots=True)
class Goal:
    """What a better trial is.

    Args:
        weights: Weight of each metric in the cost, > 0. Metrics count relative to those
            of the first trial, so that the cost of the first trial is 1.
        bounds: What must hold besides.

    Raises:
        UnknownParameterError: There is no such metric.
        ImpossibleRangeError: A weight is not positive, or there is none.
    """

    weights: Mapping[str, float] = field(default_factory=lambda: {"rms_error": 1.0})
    bounds: Sequence[Bound] = (
        Bound("effort_rms", 1.0, is_relative=True),
        Bound("effort_peak", 1.0, is_relative=True),
        Bound("violations", 0.0),
    )

    def __post_init__(self) -> None:
        for name, weight in self.weights.items():
            check_metric(name)
            if not 0.0 < weight < math.inf:
                raise ImpossibleRangeError(
                    f"The weight of '{name}' is {weight:g}; allowed are numbers > 0."
                )
        if not self.weights:
            raise ImpossibleRangeError("A goal needs one weight at least.")

    def cost(self, result: TrialResult, first: Mapping[str, float]) -> float:
        """Return the cost of a trial: 1 for the first one, lower is better.

        Args:
            result: What came out of it.
            first: The metrics of the first trial.

        Raises:
            ExperimentError: The first trial lacks a metric of the goal.
        """
        wanted = {*self.weights, *(b.metric for b in self.bounds if b.is_relative)}
        missing = sorted(wanted - set(first))
        if missing:
            raise ExperimentError(
                f"The first trial has no metric '{missing[0]}'.",
                remedy=suggest(missing[0], first),
            )
        if result.state == "failed":
            return _FAILED
        excess = sum(bound.excess(result.metrics, first) for bound in self.bounds)
        if excess > 0.0:
            return _VIOLATED + excess
        total = sum(self.weights.values())
        shares = (
            weight * self._share(name, result.metrics, first)
            for name, weight in self.weights.items()
        )
        return sum(shares) / total

    @staticmethod
    def _share(
        name: str, metrics: Mapping[str, float], first: Mapping[str, float]
    ) -> float:
        if name not in metrics:
            return _VIOLATED  # e.g. a step that never settles
        value, before = metrics[name], first[name]
        if name in LARGER_IS_BETTER:
            value, before = before, value
        return value / max(abs(before), 1e-12)


@dataclass(slots=True)
class Tuned:
    """The end of a search.

    Attributes:
        first: The trial at which it began.
        first_result: What came out of it.
        best: The best trial that keeps all bounds; `first` when none is better.
        best_result: What came out of it.
        best_cost: Its cost; that of `first` is 1.
        progress: How far the search came.
        stopped: Why it ended.
    """

    first: Trial
    first_result: TrialResult
    best: Trial
    best_result: TrialResult
    best_cost: float
    progress: Progress
    stopped: str


@dataclass(frozen=True, slots=True)
class Search:
    """How the search is done.

    Attributes:
        trials: Most trials, the first one among them, >= 2; a generation that does
            not fit any more is left out.
        seed: Seed of CMA-ES, >= 0.
        spread: First standard deviation of the logarithms of the gains, > 0.
        farthest: Largest factor by which a gain may change either way, > 1.
        patience: Ends after so many generations without a better trial, >= 1.
    """

    trials: int = 300
    seed: int = 1
    spread: float = 0.4
    farthest: float = 20.0
    patience: int = 15


def tunable_gains(
    gains: Mapping[str, float], suffixes: Sequence[str] = ("p", "i", "d")
) -> dict[str, float]:
    """Return the gains that a search changes: positive ones with a suffix.

    A gain of 0 is a decision that a factor cannot change.

    Args:
        gains: Gains by name, such as `panda_joint1/p`.
        suffixes: What their names end in, after a `/` or as a whole.

    Raises:
        UnknownParameterError: There is none.
    """
    found = {
        name: value
        for name, value in gains.items()
        if name.rpartition("/")[2] in suffixes and value > 0.0
    }
    if not found:
        raise UnknownParameterError(
            f"There is no positive gain that ends in {' or '.join(suffixes)}.",
            remedy=suggest(suffixes[0] if suffixes else "", gains),
        )
    return found


def tune(
    first: Trial,
    gains: Mapping[str, float],
    goal: Goal,
    search: Search,
    results: Results,
    executor: Executor,
    watch: Watcher = lambda _: None,
) -> Tuned:
    """Search for the gains with the lowest cost.

    The generations follow from the seed and the results alone. So a search that was
    killed goes on where it was, and finds the same on any number of workers.

    Args:
        first: The trial at which it begins, with the present gains.
        gains: The gains that may change, by parameter (`gains/arm/panda_joint1/p`), and
            where they begin, > 0.
        goal: What a better trial is.
        search: How it is done.
        results: Where the trials are kept.
        executor: Where they run.
        watch: Is told after every trial.

    Raises:
        ExperimentError: The first trial fails, or lacks a metric of the goal.
    """
    import cma

    if search.trials < 2:
        raise ExperimentError(
            f"A search of {search.trials} trials finds nothing; allowed are 2 or more."
        )
    runner = Runner(results, executor, _counted(results, search.trials, watch))
    progress = runner.run([first], search.trials)
    begun = results.find(first.hash)
    if begun is None or begun.state == "failed":
        why = "It was interrupted." if begun is None else begun.reason
        raise ExperimentError(
            f"The search cannot begin: the first trial {first.hash} has failed. {why}",
            remedy="Begin with gains under which the robot carries the script out.",
        )
    names = list(gains)
    edge = math.log(search.farthest)
    strategy = cma.CMAEvolutionStrategy(
        [0.0] * len(names),
        search.spread,
        # A seed of 0 means the clock to cma.
        {"seed": search.seed + 1, "bounds": [-edge, edge], "verbose": -9},
    )
    found = Tuned(
        *(first, begun, first, begun, goal.cost(begun, begun.metrics), progress),
        "all trials have been run",
    )
    seen, idle = {first.hash}, 0
    size = strategy.popsize
    while len(seen) + size <= search.trials and not progress.is_interrupted:
        points = strategy.ask()
        candidates = [
            first.with_parameters({
                name: float(f"{gains[name] * math.exp(x):.6g}")
                for name, x in zip(names, point, strict=True)
            })
            for point in points
        ]
        progress = runner.run(candidates, search.trials)
        seen.update(trial.hash for trial in candidates)
        costs = []
        for trial in candidates:
            result = results.find(trial.hash)
            if result is None:
                break
            costs.append(goal.cost(result, begun.metrics))
            if costs[-1] < found.best_cost:
                found.best, found.best_result = trial, result
                found.best_cost, idle = costs[-1], -1
        found.progress = progress
        if len(costs) < len(candidates):
            break
        strategy.tell(points, costs)
        idle += 1
        if idle >= search.patience or strategy.stop():
            found.stopped = f"no better trial in {max(idle, 1)} generations"
            break
    if progress.is_interrupted:
        found.stopped = "interrupted"
    return found


def _counted(results: Results, total: int, watch: Watcher) -> Watcher:
    """Return a watcher that is told of the whole search instead of a generation."""

    def tell(progress: Progress) -> None:
        ended = results.count()
        watch(
            Progress(
                *(max(total, ended), ended, progress.failed, progress.resumed),
                progress.repeated,
                progress.refused,
            )
        )

    return tell
