"""Prepare and run requested experiments, for the command line and the API."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor

from typing_extensions import override

from station.core.errors import StationError, suggest
from station.experiments.designs import parse_range, points
from station.experiments.runner import Progress, Runner, Watcher
from station.experiments.trial_world import TrialWorld, default_script
from station.experiments.tuning import Search, Tuned, tunable_gains, tune
from station.trials.analysis import objective_as_plan, ranked
from station.trials.errors import UnknownParameterError
from station.trials.metrics import check_measured
from station.trials.objective import Bound, Objective
from station.trials.parameters import check
from station.trials.results import Results
from station.trials.trial import Script, Setup, Trial
from station.wire.experiments import ExperimentRequest

ROBUSTNESS_RANGES = ("load=0:3", "friction=0.25:0.75", "delay=0:3")
"""Deviations that a robot may meet: a load that it does not know [kg], friction of 0.5
Nm plus or minus a half of it, and up to three cycles of delay."""


def sweep(
    base: Trial,
    points: Sequence[Mapping[str, float]],
    results: Results,
    executor: Executor,
    watch: Watcher = lambda _: None,
    *,
    has_seeds: bool = False,
) -> Progress:
    """Run a trial for every point in parameter space.

    Args:
        base: The trial that the points change.
        points: Parameters of each trial.
        results: File of the trials.
        executor: Runs the trials.
        watch: Called after every trial.
        has_seeds: Whether each trial has different measurement noise: its seed is then
            the seed of `base` plus its number.

    Raises:
        ExperimentError: Workers die or refuse again and again; ended trials are kept.
    """
    trials = (
        base.with_parameters(point, base.seed + number if has_seeds else None)
        for number, point in enumerate(points)
    )
    return Runner(results, executor, watch).run(trials, len(points))


def keep_worst(results: Results, metric: str, count: int) -> list[str]:
    """Run the worst trials again and keep their recordings; return their hashes.

    A trial gives the same numbers every time, so the worst trials can be recorded after
    they are known. Failed trials are worse than all others.

    Args:
        results: The experiment.
        metric: Metric that ranks the trials.
        count: Number of trials to keep, >= 0.

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


Gains = Mapping[str, Mapping[str, float]]


class Experiment(ABC):
    """An experiment that is ready to run.

    Args:
        request: The request of the caller.
        base: The trial from which all others differ by parameters.
        gains: Gains of the configuration, by controller and name.

    Attributes:
        kind: Kind of experiment: `sweep`, `robustness` or `tune`.
        setup: The configuration of all its trials.
        plan: Settings at its start, as plain data; equal plans mean the same
            experiment.
    """

    def __init__(self, request: ExperimentRequest, base: Trial, gains: Gains) -> None:
        self.kind = request.kind
        self.setup = base.setup
        self._request = request
        self._base = base
        self.plan: dict[str, object] = {
            "base": base.to_json(),
            "controller": request.controller,
            "gains_before": {name: dict(values) for name, values in gains.items()},
            "seed": request.seed,
            "trials": request.trials,
        }

    @property
    def stopped(self) -> str:
        """Return the reason for the end of the experiment; empty without one."""
        return ""

    @abstractmethod
    def run(
        self, results: Results, executor: Executor, watch: Watcher = lambda _: None
    ) -> Progress:
        """Run the experiment to its end.

        Args:
            results: File of the trials.
            executor: Runs the trials.
            watch: Called after every trial.

        Raises:
            ExperimentError: The experiment cannot go on; ended trials are kept.
        """


class SweepExperiment(Experiment):
    """Trials with many values of parameters, evenly spread or random."""

    def __init__(self, request: ExperimentRequest, base: Trial, gains: Gains) -> None:
        super().__init__(request, base, gains)
        texts = list(request.ranges)
        is_chance = request.kind == "robustness"
        if is_chance and not texts:
            texts = list(ROBUSTNESS_RANGES)
        method = "random" if is_chance else request.method
        check_measured(request.metric, base.script)
        self._points = points(
            [parse_range(text) for text in texts], method, request.trials, request.seed
        )
        self._has_seeds = method == "random"
        self.plan |= {"ranges": texts, "method": method, "trials": len(self._points)}

    def check(self, world: TrialWorld) -> None:
        """Refuse parameters that no trial could have.

        It does not check ranges of gains: a value beyond one only fails its own trial.

        Raises:
            StationError: There is no such controller, gain or joint.
        """
        # All points have the same parameters, so one point is enough.
        world.check({**self._base.parameters, **self._points[0]})

    @override
    def run(
        self, results: Results, executor: Executor, watch: Watcher = lambda _: None
    ) -> Progress:
        progress = sweep(
            *(self._base, self._points, results, executor, watch),
            has_seeds=self._has_seeds,
        )
        if self.kind == "robustness" and not progress.is_interrupted:
            keep_worst(results, self._request.metric, self._request.keep_worst)
        return progress


class TuneExperiment(Experiment):
    """A search for better gains.

    Attributes:
        tuned: Result of the search; None before its end.
    """

    def __init__(
        self,
        request: ExperimentRequest,
        base: Trial,
        gains: Gains,
        start: Mapping[str, float],
        ranges: Mapping[str, tuple[float, float]],
    ) -> None:
        super().__init__(request, base, gains)
        self._search = Search(request.trials, request.seed)
        prefix = f"gains/{request.controller}/"
        chosen = tunable_gains(_of_joints(start, request.joints), request.gains)
        self._gains = {f"{prefix}{name}": value for name, value in chosen.items()}
        self._ranges = {f"{prefix}{name}": ranges[name] for name in chosen}
        self._objective = _objective(request)
        for metric in (
            *self._objective.weights,
            *(b.metric for b in self._objective.bounds),
        ):
            check_measured(metric, base.script)
        self._first = Trial(
            base.setup, base.script, {**base.parameters, **self._gains}, base.seed
        )
        self.tuned: Tuned | None = None
        self.plan |= {
            "first": self._first.hash,
            "goal": objective_as_plan(self._objective),
            "gains": self._gains,
        }
        # A search may be continued with more trials, so their number is no part of its
        # plan.
        del self.plan["trials"]

    @property
    @override
    def stopped(self) -> str:
        return "" if self.tuned is None else self.tuned.stopped

    @override
    def run(
        self, results: Results, executor: Executor, watch: Watcher = lambda _: None
    ) -> Progress:
        self.tuned = tune(
            *(self._first, self._gains, self._objective, self._search),
            *(results, executor, watch),
            ranges=self._ranges,
        )
        return self.tuned.progress


def carry_out(
    experiment: Experiment,
    results: Results,
    executor: Executor,
    watch: Watcher = lambda _: None,
) -> Progress:
    """Run an experiment to its end, and note the reason of the end in its results.

    Args:
        experiment: Experiment to run.
        results: File of the trials.
        executor: Runs the trials.
        watch: Called after every trial.

    Raises:
        StationError: The experiment cannot go on, or another process runs it; ended
            trials are kept.
        KeyboardInterrupt: It was interrupted before its first trial.
    """
    with results.running():
        return _carry_out(experiment, results, executor, watch)


def _carry_out(
    experiment: Experiment, results: Results, executor: Executor, watch: Watcher
) -> Progress:
    """Run an experiment that no other process runs.

    Raises:
        StationError: The experiment cannot go on; ended trials are kept.
        KeyboardInterrupt: It was interrupted before its first trial.
    """
    results.set_outcome("running")
    try:
        progress = experiment.run(results, executor, watch)
    except KeyboardInterrupt:
        results.set_outcome("cancelled")
        raise
    except StationError as error:
        results.set_outcome("failed", f"{error.message} {error.remedy}".strip())
        raise
    state = "cancelled" if progress.is_interrupted else "done"
    results.set_outcome(state, experiment.stopped)
    return progress


def prepare(
    setup: Setup, request: ExperimentRequest, live: Gains | None = None
) -> Experiment:
    """Check a request, and return an experiment that is ready to run.

    Args:
        setup: The configuration of the trials.
        request: Request of the caller.
        live: Gains in force in a running station, by controller and name; None takes
            those of the configuration.

    Raises:
        StationError: A name, a value or the configuration is not allowed.
    """
    for name, value in request.parameters.items():
        check(name, value)
    controller = request.controller
    with TrialWorld(setup) as world:
        configured = world.all_gains()
        present = {**world.gains(controller), **(live or {}).get(controller, {})}
        script = _script(world, request)
        trial = Trial(setup, script, request.parameters)
        world.check(request.parameters)
        scaled = world.gains_of(trial).get(controller, {})
        if request.kind != "tune":
            parameters = {**_changed(controller, present, configured)}
            base = trial.with_parameters({**parameters, **request.parameters})
            experiment = SweepExperiment(request, base, configured)
            experiment.check(world)
            return experiment
        start = {**present, **_rescaled(request, present, scaled)}
        kept = {
            name: value
            for name, value in request.parameters.items()
            if not name.startswith((f"scale/{controller}/", f"gains/{controller}/"))
        }
        base = Trial(setup, script, {**kept, **_changed(controller, start, configured)})
        ranges = world.gain_ranges(controller)
        return TuneExperiment(request, base, configured, start, ranges)


def _rescaled(
    request: ExperimentRequest, present: Mapping[str, float], found: Mapping[str, float]
) -> dict[str, float]:
    """Return the present gains, rescaled as the parameters of a search rescale them.

    Args:
        request: Request of the caller.
        present: The gains before the search.
        found: Gains that follow from the configuration and the parameters.
    """
    begin = f"scale/{request.controller}/"
    factors = {
        name.removeprefix(begin): factor
        for name, factor in request.parameters.items()
        if name.startswith(begin)
    }
    scaled = {
        gain: value * factor
        for suffix, factor in factors.items()
        for gain, value in present.items()
        if gain.endswith(f"/{suffix}")
    }
    named = {
        gain: value
        for gain, value in found.items()
        if f"gains/{request.controller}/{gain}" in request.parameters
    }
    return {**scaled, **named}


def _changed(
    controller: str, gains: Mapping[str, float], configured: Gains
) -> dict[str, float]:
    """Return the parameters that set gains which differ from the configuration."""
    before = configured.get(controller, {})
    return {
        f"gains/{controller}/{name}": value
        for name, value in gains.items()
        if before.get(name) != value
    }


def _script(world: TrialWorld, request: ExperimentRequest) -> Script:
    """Return the script of the trials.

    Raises:
        UnknownParameterError: The controller has no such joint.
        ExperimentError: There is no script, and the station cannot make a default one.
        StationError: The controller is not loaded.
    """
    world.gains(request.controller)  # refuses a controller that is not loaded
    if request.commands is not None:
        return Script(
            controller=request.controller,
            duration=request.duration,
            commands=tuple(request.commands),
            begin=dict(request.begin),
            settling_band=request.settling_band,
        )
    script = default_script(world, request.controller)
    if request.joints is None:
        return script.model_copy(update={"begin": dict(request.begin)})
    known = [motion.joint for motion in script.motions]
    for joint in request.joints:
        if joint not in known:
            raise UnknownParameterError(
                f"Controller '{request.controller}' has no joint '{joint}'.",
                remedy=suggest(joint, known),
                details={"joint": joint},
            )
    commands = tuple(m for m in script.motions if m.joint in request.joints)
    return script.model_copy(
        update={"commands": commands, "begin": dict(request.begin)}
    )


def _of_joints(
    gains: Mapping[str, float], joints: list[str] | None
) -> Mapping[str, float]:
    """Return the gains of some joints; of all joints if `joints` is None.

    Raises:
        UnknownParameterError: A joint has no gains.
    """
    if joints is None:
        return gains
    known = list(dict.fromkeys(name.rpartition("/")[0] for name in gains))
    for joint in joints:
        if joint not in known:
            raise UnknownParameterError(
                f"The controller has no gains of '{joint}'.",
                remedy=suggest(joint, known),
                details={"joint": joint},
            )
    return {
        name: value
        for name, value in gains.items()
        if name.rpartition("/")[0] in joints
    }


def _objective(request: ExperimentRequest) -> Objective:
    if request.bounds is None:
        return Objective(request.weights)
    bounds = tuple(
        Bound(each.metric, each.limit, is_relative=each.is_relative)
        for each in request.bounds
    )
    return Objective(request.weights, bounds)
