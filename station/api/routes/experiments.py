"""Experiments: many trials in simulated copies, while the station runs."""

from typing import Annotated

from fastapi import Depends, Path, Query

from station.api.dependencies import ServicesDep, StationDep
from station.api.routes.routing import change, problems, routes_of
from station.core.facade.station import Station
from station.trials import reports
from station.trials.analysis import gains_of, ranked
from station.trials.background_experiments import BackgroundExperiments
from station.trials.errors import ExperimentError
from station.trials.metrics import UNITS
from station.trials.results import Results, file_of, names
from station.wire import ExperimentRequest, GainsChanges
from station.wire.base import FileName
from station.wire.experiments import (
    Experiment,
    ExperimentApplyRequest,
    ExperimentPreview,
    ExperimentResponses,
    Experiments,
    ExperimentTrials,
    TrialHash,
)


async def get_background(services: ServicesDep) -> BackgroundExperiments:
    """Return the runner of the station's experiments.

    Raises:
        ExperimentError: This station runs no experiments.
    """
    if services.experiments is None:
        raise ExperimentError(
            "This station runs no experiments.",
            remedy="Run them with the command line: `station tune --help`.",
        )
    return services.experiments


BackgroundDep = Annotated[BackgroundExperiments, Depends(get_background)]
Name = Annotated[
    FileName,
    Path(description="Name of the experiment.", examples=["better"]),
]
ChosenTrial = Annotated[
    TrialHash | None,
    Query(
        description="Hash of the trial, or the beginning of it; the best when left "
        "out.",
        examples=["3f2a9c0d11e4b765"],
    ),
]
Metric = Annotated[
    str | None,
    Query(
        max_length=100,
        description="The metric that decides; that of the experiment when left out.",
        examples=["rms_error"],
    ),
]
Count = Annotated[
    int, Query(ge=1, le=500, description="How many trials at most.", examples=[5])
]
router = routes_of("experiments", "/experiments")


@router.get("", responses=problems(409))
def list_experiments(background: BackgroundDep) -> Experiments:
    """List the experiments of this user, by name, and all metrics."""
    found = []
    for name in names():
        with Results.open(file_of(name)) as results:
            found.append(reports.summary_of(results, background.state))
    return Experiments(experiments=found, metrics=dict(UNITS))


@router.post("", status_code=201, **change(404, 409, 413, 422))
def start_experiment(
    request: ExperimentRequest, background: BackgroundDep, station: StationDep
) -> Experiment:
    """Start an experiment in a separate process; one runs at a time.

    The station checks the whole request before it answers. The robot does not move: the
    trials run in simulated copies of the station, with the controllers that are loaded
    now.
    """
    loaded = {}
    for status in station.controllers():
        parameters = station.parameters.get(status.name)
        if isinstance(parameters, dict):
            loaded[status.name] = parameters
    name = background.start(request, station.tuning.all_gains(), loaded)
    return _experiment(name, background)


@router.get("/{name}", responses=problems(404, 409, 422))
def get_experiment(name: Name, background: BackgroundDep) -> Experiment:
    """Return the progress of an experiment, its first trial and the best so far."""
    return _experiment(name, background)


@router.delete("/{name}", **change(404, 409, 422))
def delete_experiment(name: Name, background: BackgroundDep) -> Experiment:
    """Delete an ended experiment; return its last state."""
    found = _experiment(name, background)
    background.delete(name)
    return found


@router.post("/{name}/cancel", **change(404, 409, 422))
def cancel_experiment(name: Name, background: BackgroundDep) -> Experiment:
    """End the running experiment after its running trials, and keep all trials."""
    background.cancel(name)
    return _experiment(name, background)


@router.get("/{name}/trials", responses=problems(404, 409, 422))
def list_trials(
    name: Name,
    _: BackgroundDep,
    after: Annotated[
        int,
        Query(
            ge=0, description="Number of the last trial that is known.", examples=[0]
        ),
    ] = 0,
    count: Count = 100,
) -> ExperimentTrials:
    """Return the trials that have ended, in the order of ending."""
    with Results.open(file_of(name)) as results:
        rows = results.rows_after(after, count)
        return reports.trials_of(results, rows)


@router.get("/{name}/best", responses=problems(404, 409, 422))
def list_best_trials(
    name: Name, _: BackgroundDep, metric: Metric = None, count: Count = 5
) -> ExperimentTrials:
    """Return the best trials, the best first."""
    with Results.open(file_of(name)) as results:
        return reports.trials_of(results, ranked(results, metric)[:count])


@router.get("/{name}/responses", responses=problems(404, 409, 422))
def get_responses(name: Name, _: BackgroundDep) -> ExperimentResponses:
    """Return the kept responses of the first and best trial, or of the worst trials."""
    with Results.open(file_of(name)) as results:
        return reports.responses_of(results)


@router.get("/{name}/preview", responses=problems(404, 409, 422))
def preview_experiment(
    name: Name, _: BackgroundDep, station: StationDep, trial: ChosenTrial = None
) -> ExperimentPreview:
    """Return the changes that would put the gains of a trial into force."""
    with Results.open(file_of(name)) as results:
        chosen = reports.chosen_trial(results, trial)
        wanted = gains_of(results, chosen)
    present = {controller: station.tuning.gains(controller) for controller in wanted}
    return ExperimentPreview.model_validate({
        "experiment": name,
        "trial": chosen.hash,
        "differences": [
            {
                "controller": controller,
                "name": gain,
                "saved": value,
                "present": present[controller].values.get(gain),
            }
            for controller, gains in wanted.items()
            for gain, value in gains.items()
            if present[controller].values.get(gain) != value
        ],
        "revisions": {c: gains.revision for c, gains in present.items()},
    })


@router.post("/{name}/apply", **change(404, 409, 412, 413, 422, 503))
def apply_experiment(
    name: Name,
    _: BackgroundDep,
    services: ServicesDep,
    request: ExperimentApplyRequest | None = None,
) -> GainsChanges:
    """Put the gains of a trial into force, for all controllers in the same cycle.

    The gains are saved as a gain set of the experiment's name. `undo` restores all
    previous gains.
    """
    asked = request or ExperimentApplyRequest()
    with Results.open(file_of(name)) as results:
        wanted = gains_of(results, reports.chosen_trial(results, asked.trial))
    changes = _apply(services.station, wanted, asked)
    services.gain_sets.save(name, list(wanted))
    return GainsChanges.model_validate({"changes": changes})


def _apply(
    station: Station,
    wanted: dict[str, dict[str, float]],
    asked: ExperimentApplyRequest,
) -> object:
    return station.tuning.set_many(wanted, asked.revisions)


def _experiment(name: str, background: BackgroundExperiments) -> Experiment:
    with Results.open(file_of(name)) as results:
        return reports.experiment_of(results, background.state)
