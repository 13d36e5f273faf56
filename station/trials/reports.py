"""Make the API's reports on experiments, from their files and the running process."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Literal

import numpy as np

from station.trials.analysis import best_of, cost_of, first_of, ranked
from station.trials.background_experiments import RUNNING, RunState
from station.trials.results import Results, Row, is_written
from station.trials.trace import Trace
from station.trials.trial import Trial
from station.wire.experiments import (
    Experiment,
    ExperimentResponse,
    ExperimentResponses,
    ExperimentSummary,
    ExperimentTrial,
    ExperimentTrials,
)

_POINTS = 400
"""Most times of a response."""


def summary_of(results: Results, state: RunState | None) -> ExperimentSummary:
    """Return the summary and the progress of an experiment.

    Args:
        results: The experiment.
        state: Progress of the experiment that this station runs or ran last; None
            before any.
    """
    return ExperimentSummary.model_validate(_summary(results, state))


def experiment_of(results: Results, state: RunState | None) -> Experiment:
    """Return an experiment with its first trial and its best.

    Args:
        results: The experiment.
        state: Progress of the experiment that this station runs or ran last; None
            before any.
    """
    first, best = first_of(results), best_of(results)
    return Experiment.model_validate({
        **_summary(results, state),
        "first": None if first is None else _trial(first),
        "best": None if best is None else _trial(best),
        "cost": None if best is None else cost_of(results, best),
        "left": _left(state) if _is_of(results, state) else None,
    })


def trials_of(results: Results, rows: Sequence[Row]) -> ExperimentTrials:
    """Return the report on some trials of an experiment."""
    trials = [ExperimentTrial.model_validate(_trial(row)) for row in rows]
    return ExperimentTrials(trials=trials, ended=results.count())


def responses_of(results: Results) -> ExperimentResponses:
    """Return the responses of the trials that were kept cycle by cycle."""
    first, best = first_of(results), best_of(results)
    roles: dict[str, Literal["first", "best", "worst"]] = {}
    if best is not None:
        roles[best.result.hash] = "best"
    if first is not None:
        roles[first.result.hash] = "first"
    found = [
        _response(name, roles.get(name, "worst"), trace)
        for name, trace in results.recordings().items()
    ]
    order = ("first", "best", "worst")
    return ExperimentResponses(
        responses=sorted(found, key=lambda one: order.index(one.role))
    )


def chosen_trial(results: Results, trial: str | None) -> Trial:
    """Return a trial by its hash; the best trial if the hash is None.

    Raises:
        ExperimentError: No trial is done.
        ExperimentNotFoundError: There is no such trial.
    """
    return results.trial(trial or ranked(results)[0].result.hash)


def _is_of(results: Results, state: RunState | None) -> bool:
    return state is not None and state.name == results.path.stem


def _summary(results: Results, state: RunState | None) -> dict[str, object]:
    noted, reason = results.outcome()
    total = results.plan.get("trials", 0)
    if noted == RUNNING or not noted:
        noted = RUNNING if is_written(results.path) else "unfinished"
    if state is not None and _is_of(results, state):
        noted, reason, total = state.state, state.reason, state.total
    return {
        "name": results.path.stem,
        "kind": results.kind,
        "controller": str(results.plan.get("controller", "")),
        "state": noted,
        "reason": reason,
        "created_at": datetime.fromtimestamp(results.created(), UTC).isoformat(
            timespec="seconds"
        ),
        "trials": total if isinstance(total, int) else 0,
        "ended": results.count(),
        "failed": results.count("failed"),
    }


def _left(state: RunState | None) -> float | None:
    """Return the time that is left at the present pace [s]."""
    if state is None or state.state != RUNNING:
        return None
    done = state.ended - state.resumed
    return (state.total - state.ended) * state.seconds / done if done > 0 else None


def _trial(row: Row) -> dict[str, object]:
    result = row.result
    return {
        "hash": result.hash,
        "number": row.number,
        "state": result.state,
        "reason": result.reason,
        "parameters": dict(row.parameters),
        "seed": row.seed,
        "metrics": dict(result.metrics),
        "seconds": result.seconds,
    }


def _response(
    name: str, role: Literal["first", "best", "worst"], trace: Trace
) -> ExperimentResponse:
    every = slice(None, None, max(1, math.ceil(len(trace.time) / _POINTS)))
    return ExperimentResponse(
        hash=name,
        role=role,
        joints=list(trace.joints),
        time=np.round(trace.time[every], 6).tolist(),
        desired=trace.desired[every].tolist(),
        position=trace.position[every].tolist(),
        effort=trace.effort[every].tolist(),
    )
