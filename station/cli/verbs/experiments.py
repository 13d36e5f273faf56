"""Verbs `sweep`, `robustness`, `tune` and `identify`."""

import sys
import time
from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_json, say_progress, say_table
from station.experiments.default_script import default_script
from station.experiments.designs import Method, parse_range, points
from station.experiments.identification import Estimate, JointModel
from station.experiments.identification import identify as fit
from station.experiments.pools import make_pool
from station.experiments.runner import Progress, Watcher
from station.experiments.sweep import ROBUSTNESS_RANGES, keep_worst
from station.experiments.sweep import sweep as run_sweep
from station.experiments.trial_world import TrialWorld
from station.experiments.tuning import Search, tunable_gains
from station.experiments.tuning import tune as search_gains
from station.trials.analysis import goal_as_plan, summary
from station.trials.errors import ExperimentError
from station.trials.goal import Bound, Goal
from station.trials.parameters import check
from station.trials.results import Results, file_of
from station.trials.script import Script, read_script
from station.trials.setup import Setup
from station.trials.trace import Trace, read_trace
from station.trials.trial import Trial
from station.wire.excitations import Multisine

INTERRUPTED = 130
_FREQUENCIES = (0.5, 1.1, 1.9, 3.1)
_IDENTIFYING = 4.0


def sweep(options: Namespace) -> int:
    """Run a trial for each of many values of parameters."""
    return _sweep(options, options.ranges, options.method)


def robustness(options: Namespace) -> int:
    """Run trials under chance loads, friction and delays."""
    return _sweep(options, options.ranges or ROBUSTNESS_RANGES, "random")


def _sweep(options: Namespace, texts: Sequence[str], method: Method) -> int:
    ranges = [parse_range(text) for text in texts]
    places = points(ranges, method, options.trials, options.seed)
    kind = "sweep" if method != "random" or hasattr(options, "method") else "robustness"
    base, _ = _base(options)
    plan = {
        "base": base.to_json(),
        "ranges": list(texts),
        "method": method,
        "trials": options.trials,
        "seed": options.seed,
    }
    with _results(options, kind, base.setup, plan) as results:
        with _executor(options, base.setup) as executor, _watching() as watch:
            has_seeds = method == "random"
            progress = run_sweep(
                base, places, results, executor, watch, has_seeds=has_seeds
            )
        if kind == "robustness" and not progress.is_interrupted:
            keep_worst(results, options.metric, options.keep_worst)
        return _tell(results, progress, options)


def tune(options: Namespace) -> int:
    """Search for better gains."""
    goal = _goal(options)
    base, world_gains = _base(options)
    live = _live_gains(options) if options.live else world_gains
    chosen = tunable_gains(live, options.gains)
    gains = {f"gains/{options.controller}/{name}": g for name, g in chosen.items()}
    others = {
        name: value
        for name, value in base.parameters.items()
        if not name.startswith((f"scale/{options.controller}/", *gains))
    }
    first = Trial(base.setup, base.script, {**others, **gains}, base.seed)
    search = Search(options.trials, options.seed)
    plan = {
        "first": first.hash,
        "goal": goal_as_plan(goal),
        "gains": gains,
        "seed": options.seed,
    }
    began = time.monotonic()
    with _results(options, "tune", base.setup, plan) as results:
        with _executor(options, base.setup) as executor, _watching() as watch:
            tuned = search_gains(first, gains, goal, search, results, executor, watch)
        if options.json:
            say_json({
                "experiment": results.path.stem,
                "best": tuned.best.hash,
                "cost": tuned.best_cost,
                "stopped": tuned.stopped,
                "refused": tuned.progress.refused,
                "first": dict(tuned.first_result.metrics),
                "metrics": dict(tuned.best_result.metrics),
                "gains": dict(tuned.best.parameters),
            })
        else:
            before, now = tuned.first_result.metrics, tuned.best_result.metrics
            rows = [
                [k, f"{before[k]:.4g}", f"{now[k]:.4g}"] for k in before if k in now
            ]
            say_table(["metric", "first", "best"], rows)
            say(
                f"{results.count()} trials in {time.monotonic() - began:.0f} s, cost "
                f"{tuned.best_cost:.3f} of the first; it ended because "
                f"{tuned.stopped}."
            )
            _say_refused(tuned.progress)
            name = results.path.stem
            if tuned.best == tuned.first:
                say(
                    "No trial that keeps the bounds was better than the first; a looser"
                )
                say("bound may help, such as --at-most effort_peak=1.5x violations=0.")
            else:
                say(f"`station experiments apply {name}` shows what would change.")
        return INTERRUPTED if tuned.progress.is_interrupted else 0


def identify(options: Namespace) -> int:
    """Fit friction and inertia of a joint to a motion."""
    if options.recording is None:
        trace = _excite(options)
    else:
        trace = read_trace(options.recording)
    found = fit(trace, options.joint)
    if options.record is not None:
        options.record.write_bytes(trace.to_bytes())
    if options.json:
        say_json({
            name: {"value": one.value, "half_width": one.half_width, "unit": one.unit}
            for name, one in _estimates(found).items()
        })
        return 0
    rows = [
        [name, f"{one.value:.4g}", f"± {one.half_width:.2g}", one.unit]
        for name, one in _estimates(found).items()
    ]
    say_table(["parameter", "value", "95 %", "unit"], rows)
    say(f"{found.samples} samples; {found.residual:.3g} Nm or N are not explained.")
    return 0


def _base(options: Namespace) -> tuple[Trial, dict[str, float]]:
    """Return the trial that the options describe, and its controller's gains.

    Raises:
        UsageError: The script is one of another controller.
        StationError: The configuration, the script or a parameter is not usable.
    """
    setup = Setup.load(options.config, controllers=options.controllers)
    parameters = dict(_number(word, check_name=True) for word in options.parameters)
    with TrialWorld(setup) as world:
        gains = world.gains(options.controller)
        if options.script is None:
            script = default_script(world, options.controller)
        else:
            script = read_script(options.script)
            if script.controller != options.controller:
                raise UsageError(
                    f"{options.script} is a script of '{script.controller}', not of "
                    f"'{options.controller}'.",
                    remedy="Name the controller of the script.",
                )
        trial = Trial(setup, script, parameters)
        changed = world.gains_of(trial).get(options.controller, {})
        return trial, {**gains, **changed}


def _live_gains(options: Namespace) -> dict[str, float]:
    with open_client(options) as client:
        return dict(client.gains(options.controller).values)


def _goal(options: Namespace) -> Goal:
    weights = dict(_number(word) for word in options.weight) or {"rms_error": 1.0}
    if not options.at_most:
        return Goal(weights)
    bounds = []
    for word in options.at_most:
        is_relative = word.endswith("x")
        name, limit = _number(word.removesuffix("x"))
        bounds.append(Bound(name, limit, is_relative=is_relative))
    return Goal(weights, tuple(bounds))


def _number(word: str, *, check_name: bool = False) -> tuple[str, float]:
    """Return name and value of `NAME=VALUE`.

    Raises:
        UsageError: The text has another form.
    """
    name, equals, text = word.rpartition("=")
    try:
        value = float(text if equals and name else "no number")
    except ValueError as error:
        raise UsageError(
            f"{word!r} is not NAME=VALUE with a number.",
            remedy="Write it like load=1.5.",
        ) from error
    if check_name:
        check(name, value)
    return name, value


def _results(
    options: Namespace, kind: str, setup: Setup, plan: Mapping[str, object]
) -> Results:
    name = options.name or time.strftime(f"{kind}-%Y%m%d-%H%M%S")
    results = Results.create(file_of(name), kind, setup, plan)
    say_progress(f"Experiment {name}: {results.path}")
    return results


@contextmanager
def _executor(options: Namespace, setup: Setup) -> Iterator[Executor]:
    if options.cluster is None:
        executor = make_pool(options.workers)
    else:
        from station.experiments.cluster import ClusterExecutor

        executor = ClusterExecutor(options.cluster, setup.text)
    try:
        yield executor
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _watching() -> Iterator[Watcher]:
    """Show a bar with the time that is left, on a terminal alone."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("trials"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    told: set[str] = set()
    with Bar(*columns, console=console, disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task("trials", total=None)

        def watch(progress: Progress) -> None:
            bar.update(task, completed=progress.ended, total=progress.total)
            for reason in progress.refused:
                if reason not in told:
                    told.add(reason)
                    say_progress(reason)

        yield watch


def _tell(results: Results, progress: Progress, options: Namespace) -> int:
    found = summary(results)
    if options.json:
        say_json({
            "experiment": results.path.stem,
            "ended": progress.ended,
            "failed": sum(row.result.state == "failed" for row in results.rows()),
            "repeated": progress.repeated,
            "refused": progress.refused,
            "metrics": {
                d.metric: {
                    "median": d.median,
                    "p5": d.p5,
                    "p95": d.p95,
                    "worst": d.worst,
                }
                for d in found
            },
        })
    else:
        say_summary(results)
        _say_refused(progress)
        if progress.is_interrupted:
            say(f"{progress.ended} of {progress.total} trials are kept.")
            say(f"Repeat the command with --name {results.path.stem} to go on.")
    return INTERRUPTED if progress.is_interrupted else 0


def _say_refused(progress: Progress) -> None:
    """Print which workers got no work, and how often trials were given away again."""
    if progress.repeated:
        say(f"Trials were given away again {progress.repeated} times.")
    for reason in progress.refused:
        say(f"No trials for a worker: {reason}")


def say_summary(results: Results) -> None:
    """Print the distribution of each metric, and how many trials failed."""
    found = summary(results)
    say_table(
        ["metric", "median", "5 %", "95 %", "worst", "worst trial"],
        [
            [
                d.metric,
                *(f"{v:.4g}" for v in (d.median, d.p5, d.p95, d.worst)),
                d.worst_hash,
            ]
            for d in found
        ],
    )
    rows = results.rows()
    failed = [row for row in rows if row.result.state == "failed"]
    say(f"{len(rows)} trials, {len(failed)} failed.")
    for row in failed[:3]:
        say(f"  {row.result.describe()}")


def _excite(options: Namespace) -> Trace:
    """Return a simulated motion of the joint.

    Raises:
        ExperimentError: The trial failed.
    """
    setup = Setup.load(options.config, controllers=options.controllers)
    parameters = dict(_number(word, check_name=True) for word in options.parameters)
    if options.script is not None:
        script = read_script(options.script)
    else:
        motion = Multisine(
            joint=options.joint, amplitude=options.amplitude, frequencies=_FREQUENCIES
        )
        script = Script(
            controller=options.controller, duration=_IDENTIFYING, commands=(motion,)
        )
    with TrialWorld(setup) as world:
        result, trace = world.record(Trial(setup, script, parameters))
    if trace is None or result.state == "failed":
        raise ExperimentError(f"The motion failed. {result.reason}")
    return trace


def _estimates(found: JointModel) -> Mapping[str, Estimate]:
    return {
        "inertia": found.inertia,
        "viscous friction": found.viscous,
        "Coulomb friction": found.coulomb,
    }
