"""Wire models of experiments: many trials of a simulated copy of the station."""

from typing import Annotated, Literal

from pydantic import Field

from station.reports import GainDifference
from station.wire.base import (
    ControllerName,
    FromEnum,
    Items,
    Measurements,
    Reason,
    RequestModel,
    ResponseModel,
)
from station.wire.excitations import Command

ExperimentKind = Literal["sweep", "robustness", "tune"]
ExperimentStateName = Literal["running", "done", "cancelled", "failed", "unfinished"]
TrialHash = Annotated[str, Field(pattern=r"^[0-9a-f]{4,16}$")]
"""The hash of a trial, or the first characters of the hash."""


class ExperimentBound(RequestModel):
    """Bound that every trial of a search must keep.

    Attributes:
        metric: A metric, such as `effort_peak`.
        limit: Largest allowed value, in the unit of the metric or as a multiple.
        is_relative: Whether `limit` is a multiple of the metric of the first trial.
    """

    metric: str
    limit: float
    is_relative: bool = False


class ExperimentRequest(RequestModel):
    """An experiment to start.

    Attributes:
        kind: `tune` searches for better gains; `sweep` runs a trial for each of many
            values of parameters; `robustness` runs trials with random values of
            parameters.
        controller: Controller that the trials run.
        name: Its name; when empty, the name is made of the kind and the time. A request
            that repeats the request of an unfinished experiment goes on with that
            experiment.
        joints: The joints whose gains a search changes, and which the script moves
            when `commands` is left out; all of the controller when null.
        commands: Motions in each trial; small motions of the joints when null.
        duration: Length of a trial [s], above 0, at most 3600; only with `commands`.
        begin: Initial positions [rad or m], by joint; other joints begin where the
            world starts.
        settling_band: Half-width of the band of the settling time, as a share of the
            step, above 0 and below 1.
        parameters: Parameters of every trial by name, such as `load`; docs list them.
        trials: How many trials at most, 1 or more; a search needs 2.
        seed: Seed of all chance, 0 or more.
        workers: Processes, 1 or more; null for all processors but one.
        gains: Endings of the names of the gains that a search changes.
        weights: Weight of each metric that a search minimises, above 0; a metric counts
            relative to its value in the first trial.
        bounds: Constraints of a search. Null means: peak and RMS effort at most those
            of the first trial, and no violation of a limit.
        is_live: Whether the trials have the gains that are in force now instead of
            those of the configuration.
        ranges: Values of a sweep's parameters: `NAME=LOW:HIGH`, `NAME=LOW:HIGH:COUNT`
            or `NAME=A,B,C`.
        method: How a sweep spreads its trials over the ranges.
        metric: The metric by which the best and the worst trials are chosen.
        keep_worst: How many of the worst trials of `robustness` are kept cycle by
            cycle, 0 to 20.

    Example:
        {"kind": "tune", "controller": "effort_joint_trajectory_controller", "name":
         "better", "joints": ["panda_joint1"], "trials": 100}
    """

    kind: ExperimentKind
    controller: ControllerName
    name: str = Field(
        default="", max_length=100, pattern=r"^([A-Za-z0-9_][A-Za-z0-9_.-]*)?$"
    )
    joints: list[str] | None = Field(default=None, min_length=1, max_length=64)
    commands: list[Command] | None = Field(default=None, max_length=200)
    duration: Annotated[float, Field(gt=0.0, le=3600.0)] = 2.0
    begin: dict[str, float] = Field(default_factory=dict)
    settling_band: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.02
    parameters: dict[str, float] = Field(default_factory=dict)
    trials: int = Field(default=100, ge=1, le=1_000_000)
    seed: int = Field(default=1, ge=0, le=2**31)
    workers: int | None = Field(default=None, ge=1, le=256)
    gains: list[str] = Field(default=["p", "i", "d"], min_length=1, max_length=256)
    weights: dict[str, float] = Field(default={"rms_error": 1.0})
    bounds: list[ExperimentBound] | None = Field(default=None, max_length=20)
    is_live: bool = True
    ranges: list[str] = Field(default_factory=list, max_length=64)
    method: Literal["grid", "random", "halton", "sobol"] = "halton"
    metric: str = "rms_error"
    keep_worst: int = Field(default=3, ge=0, le=20)


class ExperimentTrial(ResponseModel):
    """A trial that has ended.

    Attributes:
        hash: Its name; the same trial has the same hash and numbers everywhere.
        number: Its number in the order of ending, 1 or more.
        state: `done` or `failed`.
        reason: Why it failed; empty when it is done.
        parameters: Its parameters.
        seed: Seed of its measurement noise, 0 or more.
        metrics: Its metrics by name; one that does not apply is left out.
        seconds: Wall time it took [s].
    """

    hash: str
    number: int
    state: Literal["done", "failed"]
    reason: Reason
    parameters: dict[str, float]
    seed: int
    metrics: dict[str, float]
    seconds: float


class ExperimentTrials(ResponseModel):
    """Trials of an experiment.

    Attributes:
        trials: The trials.
        ended: How many trials of the experiment have ended, 0 or more.
    """

    trials: Items[ExperimentTrial]
    ended: int


class ExperimentSummary(ResponseModel):
    """An experiment, and its progress.

    Attributes:
        name: Its name.
        kind: Kind of experiment; `tune`, `sweep` and `robustness` can be started here.
        controller: The controller of its trials; empty when it is not known.
        state: `running` here and now; `done`; `cancelled`; `failed`, see `reason`; or
            `unfinished`: begun, and this station does not run it.
        reason: Reason of its end or failure; empty without one.
        created_at: When it was started first, ISO 8601.
        trials: How many trials it has at most, 0 when that is not known.
        ended: How many have ended, 0 or more.
        failed: How many of them have failed, 0 or more.
    """

    name: str
    kind: str
    controller: str
    state: Annotated[ExperimentStateName, FromEnum]
    reason: Reason
    created_at: str
    trials: int
    ended: int
    failed: int


class Experiment(ExperimentSummary):
    """An experiment with the first of its trials and the best.

    Attributes:
        first: The trial at which a search began; null before it has ended, and in
            other experiments.
        best: The best trial so far, in a search the best one within the bounds; null
            while there is none.
        cost: Cost of the best trial of a search; the first trial has the cost 1. Null
            without a best trial.
        left: Time until the end at the present pace [s]; null when that is not known.

    Example:
        {"name": "better", "kind": "tune", "controller":
         "effort_joint_trajectory_controller", "state": "running", "reason": "",
         "created_at": "2026-11-22T09:15:00+00:00", "trials": 100, "ended": 37,
         "failed": 0, "first": null, "best": {"hash": "3f2a9c0d11e4b765", "number": 31,
         "state": "done", "reason": "", "parameters": {"gains/arm/panda_joint1/p":
         912.0}, "seed": 0, "metrics": {"rms_error": 0.0012, "effort_peak": 24.6},
         "seconds": 0.31}, "cost": 0.43, "left": 21.0}
    """

    first: ExperimentTrial | None
    best: ExperimentTrial | None
    cost: float | None
    left: float | None


class Experiments(ResponseModel):
    """Experiments, sorted by name.

    Attributes:
        experiments: The experiments.
        metrics: The unit of every metric there is, by its name.
    """

    experiments: Items[ExperimentSummary]
    metrics: dict[str, str]


class ExperimentResponse(ResponseModel):
    """Response of the joints in a trial.

    Attributes:
        hash: The trial.
        role: `first`, `best`, or `worst`.
        joints: Names of the joints, shape (n,).
        time: Time since the trial began [s], shape (k,).
        desired: Set-points at each time [unit of the set-point], shape (k, n); null
            while there was none.
        position: Measured positions [rad or m], shape (k, n).
        effort: Measured efforts [Nm or N], shape (k, n).
    """

    hash: str
    role: Literal["first", "best", "worst"]
    joints: Items[str]
    time: Items[float]
    desired: Items[Measurements]
    position: Items[Measurements]
    effort: Items[Measurements]


class ExperimentResponses(ResponseModel):
    """Responses of the trials that were kept cycle by cycle, for an overlay.

    Attributes:
        responses: The first trial of a search and the best so far, or the worst ones.
    """

    responses: Items[ExperimentResponse]


class ExperimentPreview(ResponseModel):
    """Changes that would put the gains of a trial into force.

    Attributes:
        experiment: Name of the experiment.
        trial: Hash of the trial.
        differences: The gains that would change: `saved` is the new value.
        revisions: Present revision of the gains of each controller. Send them along
            with the change, which is refused if a gain has changed since.

    Example:
        {"experiment": "better", "trial": "3f2a9c0d11e4b765", "differences":
         [{"controller": "arm", "name": "panda_joint1/p", "saved": 912.0, "present":
         600.0}], "revisions": {"arm": 4}}
    """

    experiment: str
    trial: str
    differences: Items[GainDifference]
    revisions: dict[str, int]


class ExperimentApplyRequest(RequestModel):
    """Choice of the gains to put into force.

    Attributes:
        trial: Hash of the trial, or the first characters of the hash; null for the best
            trial.
        revisions: Revisions that the preview has shown, by controller; the change is
            refused when a present revision differs. Null skips this check.

    Example:
        {"trial": null, "revisions": {"arm": 4}}
    """

    trial: TrialHash | None = None
    revisions: dict[str, int] | None = Field(default=None, max_length=64)
