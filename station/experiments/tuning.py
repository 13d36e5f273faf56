"""Search for better gains with CMA-ES, starting from the present ones."""

import math
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from station.core.errors import suggest
from station.experiments.runner import Progress, Runner, Watcher
from station.trials.errors import ExperimentError, UnknownParameterError
from station.trials.objective import Objective
from station.trials.results import Results
from station.trials.trial import Trial, TrialResult

if TYPE_CHECKING:
    import cma

# The best gains lie where a bound is just kept. So the search gets a penalty for a
# bound instead of a hard limit. The penalty gets steeper while fewer than a given share
# of a generation keep all bounds, and less steep while more of them do.
_STRICTNESS = 10.0
_STRICTER = 1.3
_KEPT = 0.4
_INSIDE = 1e-3


@dataclass(slots=True)
class Tuned:
    """The result of a search.

    Attributes:
        first: The trial at which it began.
        first_result: Result of the first trial.
        best: The best trial that keeps all bounds; `first` if no trial is better.
        best_result: Result of the best trial.
        best_cost: Cost of the best trial; `first` has the cost 1.
        progress: Progress of the search.
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
    """The options of a search.

    Attributes:
        trials: Most trials, including the first one, >= 2; a generation that would
            exceed it is left out.
        seed: Seed of CMA-ES, >= 0.
        spread: Initial standard deviation of the logarithms of the gains, > 0.
        farthest: Largest factor by which a gain may grow or shrink, > 1.
        patience: Number of generations without a better trial after which the search
            ends, >= 1.

    Raises:
        ExperimentError: There are too few trials.
    """

    trials: int = 300
    seed: int = 1
    spread: float = 0.4
    farthest: float = 20.0
    patience: int = 15

    def __post_init__(self) -> None:
        if self.trials < 2:
            raise ExperimentError(
                f"A search of {self.trials} trials finds nothing; allowed are 2 or "
                "more."
            )


def tunable_gains(
    gains: Mapping[str, float], suffixes: Sequence[str] = ("p", "i", "d")
) -> dict[str, float]:
    """Return the gains that a search changes: positive ones with one of the suffixes.

    A gain of 0 stays 0, because the search multiplies gains by factors.

    Args:
        gains: Gains by name, such as `panda_joint1/p`.
        suffixes: Endings of their names after a `/`, or whole names.

    Raises:
        UnknownParameterError: No gain can be tuned.
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
    objective: Objective,
    search: Search,
    results: Results,
    executor: Executor,
    watch: Watcher = lambda _: None,
    *,
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> Tuned:
    """Search for the gains with the lowest cost.

    The generations depend only on the seed and the results. So a killed search goes on
    where it ended, and finds the same gains with any number of workers.

    Args:
        first: The trial from which the search starts, with the present gains.
        gains: Initial values of the gains that may change, by parameter
            (`gains/arm/panda_joint1/p`), > 0.
        objective: Measure by which trials are compared.
        search: Options of the search.
        results: File of the trials.
        executor: Runs the trials.
        watch: Called after every trial.
        ranges: Smallest and largest allowed value of gains, by parameter; other gains
            may have any value.

    Raises:
        ExperimentError: The first trial fails, or lacks a metric of the objective.
        KeyboardInterrupt: Ctrl-C came before the end of the first trial.
    """
    space = _Space(gains, ranges or {}, search)
    strategy = space.strategy()
    runner = Runner(
        results, executor, lambda p: watch(_of_search(p, results, search.trials))
    )
    found = _begin(first, objective, search, results, runner)
    seen, idle, strictness = {first.hash}, 0, _STRICTNESS
    while not found.progress.is_interrupted:
        if len(seen) + strategy.popsize > search.trials:
            found.stopped = (
                f"Another generation, of {strategy.popsize} trials, would exceed "
                f"{search.trials}."
            )
            return found
        points = strategy.ask()
        candidates = [first.with_parameters(space.gains_at(p)) for p in points]
        best_before = found.best
        progress = runner.run(candidates, search.trials)
        found.progress = _of_search(progress, results, search.trials)
        ended = _judge(candidates, objective, results, found)
        if len(ended) < len(candidates):
            break
        seen.update(trial.hash for trial in candidates)
        before = found.first_result.metrics
        strategy.tell(
            points, [objective.softened(r, before, strictness) for r in ended]
        )
        kept = sum(objective.excess(r, before) <= 0.0 for r in ended)
        strictness *= 1.0 / _STRICTER if kept > _KEPT * len(ended) else _STRICTER
        idle = idle + 1 if found.best is best_before else 0
        if idle >= search.patience or strategy.stop():
            found.stopped = f"No trial was better in {max(idle, 1)} generations."
            return found
    found.stopped = "It was interrupted."
    return found


def _begin(
    first: Trial, objective: Objective, search: Search, results: Results, runner: Runner
) -> Tuned:
    """Run the first trial; return the search with it as the best.

    Raises:
        KeyboardInterrupt: Ctrl-C came before its end.
        ExperimentError: The first trial fails, or lacks a metric of the objective.
    """
    progress = _of_search(runner.run([first], search.trials), results, search.trials)
    begun = results.find(first.hash)
    if begun is None:
        raise KeyboardInterrupt
    if begun.state == "failed":
        raise ExperimentError(
            f"The search cannot begin: the first trial {first.hash} has failed. "
            f"{begun.reason}",
            remedy="Begin with gains under which the robot carries the script out.",
        )
    cost = objective.cost(begun, begun.metrics)
    return Tuned(first, begun, first, begun, cost, progress, "")


class _Space:
    """The space of a search: the logarithms of factors on the gains.

    Args:
        gains: Initial gains, by parameter, > 0.
        ranges: Smallest and largest values of gains that have limits, by parameter.
        search: Options of the search.
    """

    def __init__(
        self,
        gains: Mapping[str, float],
        ranges: Mapping[str, tuple[float, float]],
        search: Search,
    ) -> None:
        self._gains = gains
        self._search = search
        self._bounds: list[tuple[float, float]] = []
        for name, value in gains.items():
            low, high = ranges.get(name, (0.0, math.inf))
            least, most = value / search.farthest, value * search.farthest
            self._bounds.append((max(low, least), min(high, most)))

    def strategy(self) -> "cma.CMAEvolutionStrategy":
        """Return CMA-ES, which starts where all factors are 1."""
        import cma

        begin = self._gains.values()
        edges = [
            # CMA-ES cannot start on an edge, so widen the range; `gains_at` keeps the
            # true limit.
            (min(math.log(low / x), -_INSIDE), max(math.log(high / x), _INSIDE))
            for x, (low, high) in zip(begin, self._bounds, strict=True)
        ]
        lows, highs = (list(each) for each in zip(*edges, strict=True))
        # For cma a seed of 0 means the clock.
        options = {"seed": self._search.seed + 1, "bounds": [lows, highs]}
        return cma.CMAEvolutionStrategy(
            [0.0] * len(lows), self._search.spread, {**options, "verbose": -9}
        )

    def gains_at(self, point: Iterable[float]) -> dict[str, float]:
        """Return the gains at a point, rounded to six digits."""
        found = {}
        for (name, value), x, (low, high) in zip(
            self._gains.items(), point, self._bounds, strict=True
        ):
            gain = float(f"{value * math.exp(x):.6g}")
            found[name] = min(max(gain, low), high)
        return found


def _judge(
    candidates: Sequence[Trial], objective: Objective, results: Results, found: Tuned
) -> list[TrialResult]:
    """Return the results up to the first trial that has not ended; note a better one.

    Only a trial that keeps all bounds can be better.
    """
    ended: list[TrialResult] = []
    for trial in candidates:
        result = results.find(trial.hash)
        if result is None:
            break
        ended.append(result)
        cost = objective.cost(result, found.first_result.metrics)
        if cost < found.best_cost:
            found.best, found.best_result, found.best_cost = trial, result, cost
    return ended


def _of_search(progress: Progress, results: Results, total: int) -> Progress:
    """Return the progress of the whole search from that of a generation."""
    ended = results.count()
    return replace(progress, total=max(total, ended), ended=ended)
