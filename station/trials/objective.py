"""The objective of a search: the cost of a trial, and bounds on its metrics."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from station.core.errors import suggest
from station.trials.errors import ExperimentError, ImpossibleRangeError
from station.trials.metrics import LARGER_IS_BETTER, check_metric
from station.trials.trial import TrialResult

# The costs are far apart, so that a search prefers a poor trial to a violation of a
# bound, and a violation to a failure.
_FAILED = 1e6
"""Cost of a trial that failed."""
_VIOLATED = 1e3
"""Cost of a trial that violates a constraint, before the excess is added."""
_UNMEASURED = 10.0
"""Excess that a trial gets for a bounded metric which it lacks, as a share of the
bound."""
TOLERANCE = 0.001
"""Share by which a trial may exceed a bound that is relative to the first trial. Other
random noise of the sensors changes the peak of the effort by 0.7 % and its RMS by 0.03
%, so an exact comparison would depend on the noise."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A hard constraint: the largest allowed value of a metric.

    Args:
        metric: The metric.
        limit: Largest allowed value, in the unit of the metric or as a multiple;
            finite.
        is_relative: Whether `limit` is a multiple of the metric of the first trial; it
            is kept within `TOLERANCE`.

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
        """Return the excess over the bound, as a share of the bound; 0 if kept."""
        limit = self.limit
        if self.is_relative:
            limit *= first[self.metric]
            limit += TOLERANCE * abs(limit)
        found = metrics.get(self.metric)
        if found is None:  # e.g. the settling time of a joint that does not settle
            return _UNMEASURED
        return max(0.0, (found - limit) / max(abs(limit), 1e-9))


@dataclass(frozen=True, slots=True)
class Objective:
    """The cost by which trials are compared, and the bounds that they must keep.

    Args:
        weights: Weight of each metric in the cost, > 0. Metrics count relative to those
            of the first trial, so that the cost of the first trial is 1.
        bounds: Constraints on other metrics.

    Raises:
        UnknownParameterError: There is no such metric.
        ImpossibleRangeError: A weight is not positive, or there are no weights.
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
            raise ImpossibleRangeError("An objective needs one weight at least.")

    def cost(self, result: TrialResult, first: Mapping[str, float]) -> float:
        """Return the cost of a trial: 1 for the first one, lower is better.

        Args:
            result: Result of the trial.
            first: The metrics of the first trial.

        Raises:
            ExperimentError: The first trial lacks a metric of the objective.
        """
        self._check(first)
        if result.state == "failed":
            return _FAILED
        excess = self.excess(result, first)
        return _VIOLATED + excess if excess > 0.0 else self._total(result, first)

    def softened(
        self, result: TrialResult, first: Mapping[str, float], strictness: float
    ) -> float:
        """Return the cost of a trial with a smooth penalty in place of hard bounds.

        Args:
            result: Result of the trial.
            first: The metrics of the first trial, with every metric of the objective.
            strictness: Cost of an excess as large as the bound's limit, >= 0.
        """
        if result.state == "failed":
            return _FAILED
        excess = self.excess(result, first)
        return self._total(result, first) + strictness * excess

    def excess(self, result: TrialResult, first: Mapping[str, float]) -> float:
        """Return the sum of a trial's excesses over the bounds; 0 if all are kept."""
        return sum(bound.excess(result.metrics, first) for bound in self.bounds)

    def _check(self, first: Mapping[str, float]) -> None:
        wanted = {*self.weights, *(b.metric for b in self.bounds if b.is_relative)}
        missing = sorted(wanted - set(first))
        if missing:
            raise ExperimentError(
                f"The first trial has no metric '{missing[0]}'.",
                remedy=suggest(missing[0], first),
            )

    def _total(self, result: TrialResult, first: Mapping[str, float]) -> float:
        shares = (
            weight * self._share(name, result.metrics, first)
            for name, weight in self.weights.items()
        )
        return sum(shares) / sum(self.weights.values())

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
