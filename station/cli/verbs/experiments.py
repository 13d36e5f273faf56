"""Verbs `sweep`, `robustness` and `tune`: many trials of a simulated station."""

import sys
import time
from argparse import Namespace
from contextlib import contextmanager
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError, explain_fields
from station.cli.output import answer, say, say_json, say_progress, say_table
from station.cli.parser import read_number, unique
from station.cli.verbs.experiment_results import METRIC, say_summary
from station.cli.verbs.identification import add_setup, load_setup, read_parameters

if TYPE_CHECKING:
    from collections.abc import Iterator
    from concurrent.futures import Executor

    from station.cli.parser import Parser
    from station.experiments.experiment import Experiment
    from station.experiments.runner import Progress, Watcher
    from station.experiments.tuning import Tuned
    from station.trials.results import Results
    from station.trials.trial import Setup
    from station.wire.experiments import (
        ExperimentBound,
        ExperimentKind,
        ExperimentRequest,
    )

INTERRUPTED = 130
_FIGURES = ("median", "p5", "p95", "worst")


def add_sweep(parser: "Parser") -> None:
    """Add the arguments of `sweep`."""
    _add_ranges(parser, "+", "", trials=100)
    parser.add_argument(
        "--method",
        choices=("grid", "random", "halton", "sobol"),
        default="halton",
        help="how the values are spread",
    )
    _add_running(parser)


def add_robustness(parser: "Parser") -> None:
    """Add the arguments of `robustness`."""
    _add_ranges(parser, "*", "; load=0:3 friction=0.25:0.75 delay=0:3", trials=500)
    parser.add_argument(
        "--keep-worst", type=int, default=3, metavar="N", help="recordings"
    )
    _add_running(parser)


def _add_ranges(parser: "Parser", count: str, default: str, *, trials: int) -> None:
    """Add the arguments for varied parameters, number of trials and metrics."""
    add = parser.add_argument
    add("controller", metavar="CONTROLLER")
    add(
        "ranges",
        nargs=count,
        metavar="NAME=LOW:HIGH",
        help=f"or NAME=LOW:HIGH:COUNT, or NAME=A,B,C{default}",
    )
    add("--trials", type=int, default=trials, metavar="N")
    add("--metric", default="rms_error", help=METRIC)


def add_tune(parser: "Parser") -> None:
    """Add the arguments of `tune`."""
    add = parser.add_argument
    add("controller", metavar="CONTROLLER")
    add("--trials", type=int, default=300, metavar="N")
    add(
        "--gains",
        nargs="+",
        default=["p", "i", "d"],
        metavar="SUFFIX",
        help="which gains may change: p i d, or panda_joint1/p",
    )
    add(
        "--weight",
        nargs="+",
        action="extend",
        default=[],
        metavar="METRIC=W",
        help="what is to become small, relative to the first trial; rms_error=1",
    )
    add(
        "--at-most",
        nargs="+",
        action="extend",
        default=[],
        metavar="METRIC=B",
        help="hard bounds, 1.1x: of the first trial; effort_rms=1x effort_peak=1x "
        "violations=0",
    )
    add("--live", action="store_true", help="begin with the gains of a running station")
    _add_running(parser)


def _add_running(parser: "Parser") -> None:
    """Add the arguments for the trials, their workers and the results."""
    add = parser.add_argument
    add_setup(parser)
    add("--name", help="name of the experiment; without it: a new one")
    add("--workers", type=int, metavar="N", help="processes; one per processor")
    add("--cluster", metavar="tcp://HOST:8786", help="a scheduler of Dask instead")
    add("--seed", type=int, default=1, help="seed of all chance")
    add(
        "--background",
        action="store_true",
        help="let the running station do it, and come back at once",
    )


def sweep(options: Namespace) -> int:
    """Run a trial for each of many values of parameters."""
    return _sweep(options, "sweep")


def robustness(options: Namespace) -> int:
    """Run trials with random loads, friction and delays."""
    return _sweep(options, "robustness")


def _sweep(options: Namespace, kind: "ExperimentKind") -> int:
    from station.experiments.experiment import prepare

    request = _request(options, kind)
    if options.background:
        return _start(options, request)
    experiment = prepare(load_setup(options), request)
    with _running(options, experiment) as (results, progress):
        return _tell(results, progress, options)


def tune(options: Namespace) -> int:
    """Search for better gains."""
    from station.experiments.experiment import TuneExperiment, prepare

    request = _request(options, "tune")
    if options.background:
        return _start(options, request)
    setup, live = _live(options) if options.live else (load_setup(options), None)
    experiment = prepare(setup, request, live)
    began = time.monotonic()
    with _running(options, experiment) as (results, progress):
        if isinstance(experiment, TuneExperiment) and experiment.tuned is not None:
            _tell_tuned(results, experiment.tuned, time.monotonic() - began, options)
        return INTERRUPTED if progress.is_interrupted else 0


def _tell_tuned(
    results: "Results", tuned: "Tuned", seconds: float, options: Namespace
) -> None:
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
        return
    before, now = tuned.first_result.metrics, tuned.best_result.metrics
    rows = [[k, f"{before[k]:.4g}", f"{now[k]:.4g}"] for k in before if k in now]
    say_table(["metric", "first", "best"], rows)
    say(
        f"Trials: {results.count()} in {seconds:.0f} s, cost {tuned.best_cost:.3f} of "
        f"the first. {tuned.stopped}"
    )
    _say_refused(tuned.progress)
    name = results.path.stem
    if results.count() == 1:
        say("More --trials are needed for a search.")
    elif tuned.best == tuned.first:
        say("No trial that keeps the bounds was better than the first; a looser")
        say("bound may help, such as --at-most effort_peak=1.5x violations=0.")
    else:
        say(f"`station experiments apply {name}` shows what would change.")


def _start(options: Namespace, request: "ExperimentRequest") -> int:
    """Start the experiment in the running station, and return.

    Raises:
        UsageError: An option chooses where trials run, which only the station decides.
    """
    elsewhere = {
        "--cluster": options.cluster,
        "--config": options.config,
        "--controllers": options.controllers or None,
    }
    for option, value in elsewhere.items():
        if value is not None:
            raise UsageError(
                f"{option} does not go with --background.",
                remedy="The station runs trials with its own configuration, in "
                "processes of its own.",
            )
    with open_client(options) as client:
        found = client.experiments.start(request)
    return answer(
        options,
        found,
        f"The station runs {found.name}. `station experiments watch {found.name}`",
        f"shows how far it is, `station experiments cancel {found.name}` ends it.",
    )


def _request(options: Namespace, kind: "ExperimentKind") -> "ExperimentRequest":
    """Return the request that the options describe.

    Raises:
        UsageError: The script belongs to another controller, or a value is not allowed.
    """
    from pydantic import ValidationError

    from station.wire.experiments import ExperimentRequest

    fields: dict[str, object] = {
        "kind": kind,
        "controller": options.controller,
        "name": options.name or "",
        "trials": options.trials,
        "seed": options.seed,
        "is_live": getattr(options, "live", False),
        "parameters": read_parameters(options),
        **_script_fields(options),
    }
    if kind == "tune":
        fields["gains"] = options.gains
        fields["weights"] = unique(map(read_number, options.weight)) or {
            "rms_error": 1.0
        }
        fields["bounds"] = [_bound(word) for word in options.at_most] or None
    else:
        fields["ranges"] = list(options.ranges)
        fields["metric"] = options.metric
    if kind == "sweep":
        fields["method"] = options.method
    if kind == "robustness":
        fields["keep_worst"] = options.keep_worst
    if options.background and options.workers is not None:
        fields["workers"] = options.workers
    try:
        return ExperimentRequest.model_validate(fields)
    except ValidationError as error:
        raise UsageError(
            f"{'; '.join(explain_fields(error, options.typed))}.",
            remedy=f"`station {kind} --help` explains the options.",
        ) from error


def _script_fields(options: Namespace) -> dict[str, object]:
    """Return the fields of a request that a script or a recording gives.

    Raises:
        UsageError: The script belongs to another controller.
    """
    if options.script is None:
        return {}
    from station.experiments.recordings import SUFFIX, recorded_script
    from station.trials.trial import read_script

    if options.script.suffix == SUFFIX:
        script = recorded_script(options.script, options.controller)
    else:
        script = read_script(options.script)
    if script.controller != options.controller:
        raise UsageError(
            f"{options.script} is a script of '{script.controller}', not of "
            f"'{options.controller}'.",
            remedy="Name the controller of the script.",
        )
    return {
        "commands": list(script.commands),
        "duration": script.duration,
        "begin": script.begin,
        "settling_band": script.settling_band,
    }


def _live(options: Namespace) -> "tuple[Setup, dict[str, dict[str, float]]]":
    """Return the setup and the gains of a running station, to start a search.

    A controller that is not in the configuration is taken from the station.
    """
    setup, controller = load_setup(options), options.controller
    with open_client(options) as client:
        gains = {controller: dict(client.gains(controller).values)}
        if controller not in setup.config().controllers:
            loaded = client.parameter(controller)
            if isinstance(loaded, dict):
                setup = setup.with_controllers({controller: loaded})
    return setup, gains


def _bound(word: str) -> "ExperimentBound":
    from station.wire.experiments import ExperimentBound

    is_relative = word.endswith("x")
    name, limit = read_number(word.removesuffix("x"))
    return ExperimentBound(metric=name, limit=limit, is_relative=is_relative)


@contextmanager
def _running(
    options: Namespace, experiment: "Experiment"
) -> "Iterator[tuple[Results, Progress]]":
    """Run an experiment to its end; yield its results and its progress.

    Raises:
        KeyboardInterrupt: Ctrl-C came a second time, or before the first trial.
    """
    from station.experiments.experiment import carry_out

    # Make the executor first: if this fails, no file of the experiment must remain.
    with (
        _executor(options, experiment.setup) as executor,
        _results(options, experiment) as results,
    ):
        try:
            with _watching() as watch:
                progress = carry_out(experiment, results, executor, watch)
        except KeyboardInterrupt:
            _say_how_to_go_on(results)
            raise
        yield results, progress
        if progress.is_interrupted:
            _say_how_to_go_on(results)


def _say_how_to_go_on(results: "Results") -> None:
    """Print to stderr how to continue an interrupted experiment."""
    say_progress(
        f"Interrupted: {results.count()} trials are kept. Repeat the command with "
        f"--name {results.path.stem} to go on."
    )


def _results(options: Namespace, experiment: "Experiment") -> "Results":
    from station.trials.results import Results, file_of, name_of_now

    name = options.name or name_of_now(experiment.kind)
    results = Results.create(
        file_of(name), experiment.kind, experiment.setup, experiment.plan
    )
    say_progress(f"Experiment {name}: {results.path}")
    return results


@contextmanager
def _executor(options: Namespace, setup: "Setup") -> "Iterator[Executor]":
    from station.experiments.pools import ProcessPool, make_pool

    if options.cluster is None:
        executor = make_pool(options.workers)
    else:
        from station.experiments.cluster import ClusterExecutor

        executor = ClusterExecutor(options.cluster, setup.text)
    try:
        yield executor
    except KeyboardInterrupt:
        if isinstance(executor, ProcessPool):
            executor.abandon()
        raise
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _watching() -> "Iterator[Watcher]":
    """Show a progress bar with the remaining time, on a terminal only."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress as Bar,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("trials"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    said: set[str] = set()
    with Bar(*columns, console=console, disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task("trials", total=None)

        def watch(progress: "Progress") -> None:
            bar.update(task, completed=progress.ended, total=progress.total)
            news = list(progress.refused)
            if progress.is_interrupted:
                news.append("The trials that run may end; Ctrl-C again ends them now.")
            for reason in news:
                if reason not in said:
                    said.add(reason)
                    say_progress(reason)

        yield watch


def _tell(results: "Results", progress: "Progress", options: Namespace) -> int:
    from station.trials.analysis import summary

    found = summary(results)
    if options.json:
        say_json({
            "experiment": results.path.stem,
            "ended": progress.ended,
            "failed": sum(row.result.state == "failed" for row in results.rows()),
            "repeated": progress.repeated,
            "refused": progress.refused,
            "metrics": {
                d.metric: {key: getattr(d, key) for key in _FIGURES} for d in found
            },
        })
    else:
        say_summary(results)
        _say_refused(progress)
    if progress.is_interrupted:
        return INTERRUPTED
    return 0 if results.count("done") else 1


def _say_refused(progress: "Progress") -> None:
    """Print the workers that got no work, and the number of repeated trials."""
    if progress.repeated:
        say(f"Trials were given away again {progress.repeated} times.")
    for reason in progress.refused:
        say(f"No trials for a worker: {reason}")
