"""Analyse experiments: the best trial, a summary, a comparison of two."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from station.trials.errors import ExperimentError
from station.trials.metrics import LARGER_IS_BETTER, UNITS, check_metric
from station.trials.objective import Bound, Objective
from station.trials.parameters import gains_under, sort_out
from station.trials.results import Results, Row
from station.trials.trial import Trial

# One less than 10,000, because the observed order counts as one more permutation.
_PERMUTATIONS = 9999
# A fixed seed gives the same probability for the same comparison.
_SEED = 1


@dataclass(frozen=True, slots=True)
class Distribution:
    """The distribution of a metric over the trials that are done.

    Attributes:
        metric: Its name.
        median: Median.
        p5: 5th percentile.
        p95: 95th percentile.
        worst: The worst value.
        worst_hash: The trial of the worst value.
        count: Number of trials that have the metric.
    """

    metric: str
    median: float
    p5: float
    p95: float
    worst: float
    worst_hash: str
    count: int


@dataclass(frozen=True, slots=True)
class Comparison:
    """A metric in two experiments.

    Attributes:
        metric: Its name.
        means: Its mean in each experiment.
        counts: Number of trials with the metric in each experiment.
        p_value: Probability of a difference of means at least this large if both
            experiments are alike: a two-sided permutation test with 9999 permutations.
    """

    metric: str
    means: tuple[float, float]
    counts: tuple[int, int]
    p_value: float


def objective_of(results: Results) -> Objective | None:
    """Return the objective of a search; None for other experiments."""
    plan = results.plan.get("goal")
    if not isinstance(plan, dict):
        return None
    bounds = [
        Bound(name, limit, is_relative=rel) for name, limit, rel in plan["bounds"]
    ]
    return Objective(dict(plan["weights"]), tuple(bounds))


def objective_as_plan(objective: Objective) -> dict[str, object]:
    """Return an objective as plain data, for the plan of the experiment."""
    bounds = [[b.metric, b.limit, b.is_relative] for b in objective.bounds]
    return {"weights": dict(objective.weights), "bounds": bounds}


def ranked(results: Results, metric: str | None = None) -> list[Row]:
    """Return the trials that are done, the best first.

    Args:
        results: The experiment.
        metric: Metric that ranks the trials; None takes the objective of a search, or
            else `rms_error`.

    Raises:
        UnknownParameterError: The metric is unknown.
        ExperimentError: No trial is done, or no trial has the metric.
    """
    rows = results.rows()
    objective = objective_of(results) if metric is None else None
    if objective is not None and rows:
        first = _first(results, rows)
        done = [row for row in rows if row.result.state == "done"]
        if not done:
            raise ExperimentError(
                f"All trials of '{results.path.stem}' have failed.",
                remedy="`station experiments show` says why.",
            )
        return sorted(done, key=lambda row: objective.cost(row.result, first))
    name = metric or "rms_error"
    check_metric(name)
    known = [r for r in rows if r.result.state == "done" and name in r.result.metrics]
    if not known:
        raise ExperimentError(
            f"No trial of '{results.path.stem}' is done and has the metric '{name}'.",
            remedy="`station experiments show` says what the trials have.",
        )
    return sorted(
        known, key=lambda r: r.result.metrics[name], reverse=name in LARGER_IS_BETTER
    )


def _first(results: Results, rows: Sequence[Row]) -> Mapping[str, float]:
    """Return the metrics of the trial at which a search began.

    Raises:
        ExperimentError: The first trial has not ended.
    """
    for row in rows:
        if row.result.hash == results.plan.get("first"):
            return row.result.metrics
    raise ExperimentError(f"The first trial of '{results.path.stem}' has not ended.")


def first_of(results: Results) -> Row | None:
    """Return the trial at which a search began; None if there is none."""
    first = results.plan.get("first")
    return next((row for row in results.rows() if row.result.hash == first), None)


def best_of(results: Results, metric: str | None = None) -> Row | None:
    """Return the first trial of `ranked`; None while there is none.

    Raises:
        UnknownParameterError: The metric is unknown.
    """
    if metric is not None:
        check_metric(metric)
    try:
        return next(iter(ranked(results, metric)), None)
    except ExperimentError:
        return None  # no trial has ended that could be ranked


def cost_of(results: Results, row: Row) -> float | None:
    """Return the cost of a trial of a search; None in other experiments."""
    objective = objective_of(results)
    if objective is None:
        return None
    return objective.cost(row.result, _first(results, results.rows()))


def gains_of(results: Results, trial: Trial) -> dict[str, dict[str, float]]:
    """Return the gains that a trial changes, by controller and name.

    Raises:
        ExperimentError: The trial changes no gains, or scales gains whose original
            values the experiment does not know.
        UnknownParameterError: The trial scales gains that do not exist.
    """
    wanted = sort_out(trial.parameters)
    found = {name: dict(values) for name, values in wanted.gains.items()}
    if wanted.scales:
        before = results.plan.get("gains_before")
        if not isinstance(before, dict):
            raise ExperimentError(
                f"Trial {trial.hash} scales gains, and the experiment "
                f"'{results.path.stem}' does not say what they were before."
            )
        all_gains = gains_under(wanted, before)
        for controller, factors in wanted.scales.items():
            for gain, value in all_gains[controller].items():
                if gain.rpartition("/")[2] in factors:
                    found.setdefault(controller, {})[gain] = value
    if not found:
        raise ExperimentError(f"Trial {trial.hash} changes no gains.")
    return found


def summary(results: Results) -> list[Distribution]:
    """Return the distribution of each metric over the trials that are done."""
    rows = [row for row in results.rows() if row.result.state == "done"]
    found = []
    for metric in UNITS:
        known = [
            (row.result.metrics[metric], row.result.hash)
            for row in rows
            if metric in row.result.metrics
        ]
        if not known:
            continue
        p5, median, p95 = np.percentile([value for value, _ in known], [5, 50, 95])
        worst = min(known) if metric in LARGER_IS_BETTER else max(known)
        found.append(
            Distribution(
                *(metric, float(median), float(p5), float(p95)), *worst, len(known)
            )
        )
    return found


def compare(
    one: Results, other: Results, metrics: Sequence[str] = ()
) -> list[Comparison]:
    """Return the means of two experiments with the significance of their difference.

    Args:
        one: An experiment.
        other: Another one.
        metrics: Names of metrics; empty for all metrics that both have.

    Raises:
        UnknownParameterError: The metric is unknown.
        ExperimentError: The experiments have no metric in common.
    """
    found = []
    for metric in metrics or UNITS:
        check_metric(metric)
        columns = [_column(results, metric) for results in (one, other)]
        if min(map(len, columns)) < 2:
            continue
        found.append(
            Comparison(
                metric,
                (float(columns[0].mean()), float(columns[1].mean())),
                (len(columns[0]), len(columns[1])),
                _permutation_test(*columns),
            )
        )
    if not found:
        raise ExperimentError(
            f"'{one.path.stem}' and '{other.path.stem}' have no metric in common with "
            "two trials in each."
        )
    return found


Column = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def _column(results: Results, metric: str) -> Column:
    return np.array([
        row.result.metrics[metric]
        for row in results.rows()
        if row.result.state == "done" and metric in row.result.metrics
    ])


def _permutation_test(one: Column, other: Column) -> float:
    random = np.random.default_rng(_SEED)
    together = np.concatenate([one, other])
    seen = abs(one.mean() - other.mean())
    as_far = 0
    for _ in range(_PERMUTATIONS):
        random.shuffle(together)
        difference = together[: len(one)].mean() - together[len(one) :].mean()
        # The tolerance keeps rounding from making equal differences unequal.
        as_far += abs(difference) >= seen - 1e-12 * abs(seen)
    # The observed difference is one of the permutations, so p is never 0.
    return (1.0 + as_far) / (1.0 + _PERMUTATIONS)
