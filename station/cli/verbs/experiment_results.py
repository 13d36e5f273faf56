"""Verb `experiments`: results of experiments, and their use."""

from argparse import Namespace
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import (
    answer,
    answer_table,
    say,
    say_json,
    say_progress,
    say_table,
)

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.trials.results import Results
    from station.wire.experiments import Experiment

METRIC = "a metric such as rms_error, effort_rms or settling_time"
_MOST_REASONS = 5
"""Number of the most frequent reasons of failed trials that are printed."""


def add_experiments(parser: "Parser") -> None:
    """Add the arguments of `experiments`."""
    add = parser.add_argument
    add("action", choices=tuple(_ACTIONS))
    add("name", nargs="?", metavar="NAME", help="the experiment")
    add(
        "words",
        nargs="*",
        metavar="WORD",
        help="plot, export: a file; apply: a trial's hash, the best when left out; "
        "replay: one likewise, the worst when left out; compare: another experiment",
    )
    add("--metric", nargs="+", action="extend", default=[], help=METRIC)
    add("--kind", choices=("parallel", "pareto", "responses"), default="pareto")
    add("--yes", action="store_true", help="apply: do it; without it: only show it")
    add("--yaml", type=Path, metavar="FILE", help="apply: write the gains to a file")
    add("--count", type=int, default=5, help="best: how many trials")


def experiments(options: Namespace) -> int:
    """List, show, draw, rank, replay, apply, export or compare experiments.

    Raises:
        UsageError: There are too few or too many words.
    """
    action, fewest, most = _ACTIONS[options.action]
    words = [word for word in (options.name, *options.words) if word is not None]
    if not fewest <= len(words) <= most:
        raise UsageError(
            f"The words after `experiments {options.action}` are too few or too many.",
            remedy="station experiments list, show|best|watch|cancel NAME, "
            "plot|export NAME FILE, "
            "apply|replay NAME [HASH], compare NAME OTHER.",
        )
    return action(options)


def _list(options: Namespace) -> int:
    from station.trials.results import default_folder, names

    rows, found = [], []
    for name in names():
        with _opened(name) as results:
            count = results.count()
            rows.append([name, results.kind, str(count)])
            found.append({"name": name, "kind": results.kind, "trials": count})
    headers = ["experiment", "kind", "trials"]
    nothing = f"There are no experiments in {default_folder()}."
    return answer_table(options, found, headers, rows, nothing)


def _show(options: Namespace) -> int:
    from station.experiments.exports import table

    with _opened(options.name) as results:
        if options.json:
            say_json(table(results))
        else:
            say(f"{options.name}: {results.kind} of setup {results.setup.digest}")
            say_summary(results)
    return 0


def say_summary(results: "Results") -> None:
    """Print the distribution of each metric, and the number of failed trials."""
    from station.trials.analysis import summary

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
    reasons = Counter(row.result.reason for row in failed)
    for reason, count in reasons.most_common(_MOST_REASONS):
        first = next(row.result.hash for row in failed if row.result.reason == reason)
        say(f"  {first}{f' and {count - 1} more' if count > 1 else ''}: {reason}")


def _best(options: Namespace) -> int:
    from station.trials.analysis import ranked

    with _opened(options.name) as results:
        rows = ranked(results, _metric(options))[: options.count]
    found = [
        {
            "hash": row.result.hash,
            "parameters": dict(row.parameters),
            "metrics": dict(row.result.metrics),
        }
        for row in rows
    ]
    metrics = options.metric or ["rms_error", "effort_rms"]
    table = [
        [
            row.result.hash,
            *(f"{row.result.metrics.get(m, float('nan')):.4g}" for m in metrics),
            " ".join(f"{k}={v:.4g}" for k, v in row.parameters.items()),
        ]
        for row in rows
    ]
    return answer_table(options, found, ["trial", *metrics, "parameters"], table)


def _plot(options: Namespace) -> int:
    from station.experiments.plots import plot

    with _opened(options.name) as results:
        plot(results, options.kind, Path(options.words[0]), options.metric)
    say(f"Wrote {options.words[0]}.")
    return 0


def _replay(options: Namespace) -> int:
    """Run a trial again, by default the worst one, and compare its numbers."""
    # Imported late, because a list of experiments needs no simulation.
    from station.experiments.trial_world import TrialWorld
    from station.trials.analysis import ranked

    with _opened(options.name) as results:
        if options.words:
            trial = results.trial(options.words[0])
        else:
            trial = results.trial(ranked(results, _metric(options))[-1].result.hash)
        kept = results.find(trial.hash)
        with TrialWorld(results.setup) as world:
            now, trace = world.record(trial)
        if trace is not None:
            results.keep_recording(trial.hash, trace)
    before = {} if kept is None else dict(kept.metrics)
    is_same = (
        kept is not None
        and (kept.state, kept.reason) == (now.state, now.reason)
        and before == dict(now.metrics)
    )
    if options.json:
        say_json({
            "hash": trial.hash,
            "is_same": is_same,
            "state": now.state,
            "reason": now.reason,
            "parameters": dict(trial.parameters),
            "metrics": dict(now.metrics),
        })
        return int(not is_same)
    say_table(
        ["metric", "kept", "now"],
        [
            [name, f"{before.get(name, float('nan')):.6g}", f"{value:.6g}"]
            for name, value in now.metrics.items()
        ],
    )
    shown = " ".join(f"{k}={v:.4g}" for k, v in trial.parameters.items())
    say(f"Trial {trial.hash} {shown}: {now.state}. {now.reason or ''}".rstrip())
    say("The numbers are the same, bit for bit." if is_same else "THEY DIFFER.")
    return int(not is_same)


def _export(options: Namespace) -> int:
    from station.experiments.exports import export

    with _opened(options.name) as results:
        export(results, Path(options.words[0]))
    say(f"Wrote {options.words[0]}.")
    return 0


def _compare(options: Namespace) -> int:
    from station.trials.analysis import compare

    one, other = options.name, options.words[0]
    with _opened(one) as first, _opened(other) as second:
        found = compare(first, second, options.metric)
    rows = [
        [c.metric, *(f"{m:.4g}" for m in c.means), f"{c.p_value:.4f}"] for c in found
    ]
    answer_table(options, found, ["metric", one, other, "p"], rows)
    if not options.json:
        say("p: how probable means so far apart are by chance alone.")
    return 0


def _apply(options: Namespace) -> int:
    """Show the gains of a trial beside those of a running station; set with --yes."""
    from station.experiments.exports import write_gains
    from station.trials.analysis import gains_of, ranked

    with _opened(options.name) as results:
        if options.words:
            trial = results.trial(options.words[0])
        else:
            best = ranked(results, _metric(options))[0]
            trial = results.trial(best.result.hash)
        wanted = gains_of(results, trial)
    if options.yaml is not None:
        write_gains(wanted, options.yaml)
        say(f"Wrote {options.yaml}.")
        return 0
    with open_client(options) as client:
        present = {name: client.gains(name) for name in wanted}
        rows = [
            [
                name,
                gain,
                f"{present[name].values.get(gain, float('nan')):g}",
                f"{new:g}",
            ]
            for name, gains in wanted.items()
            for gain, new in gains.items()
        ]
        say_table(["controller", "gain", "present", "new"], rows)
        if not options.yes:
            say("Nothing has changed; with --yes the new gains are put into force.")
            return 0
        revisions = {name: gains.revision for name, gains in present.items()}
        client.gain_sets.set_gains(wanted, revisions)
        say(f"The gains of trial {trial.hash} are in force.")
        say("`station gains undo` takes them back.")
        client.gain_sets.save(options.name, list(wanted))
        say(f"They are saved as gain set {options.name}.")
    return 0


def _watch(options: Namespace) -> int:
    """Show the progress of an experiment of the running station, until its end."""
    with open_client(options) as client:
        found = client.experiments.wait(options.name, _say_progress)
    answer(options, found, f"{found.name}: {found.state}. {found.reason}".rstrip())
    return int(found.state == "failed")


def _say_progress(found: "Experiment") -> None:
    best = "" if found.cost is None else f", best cost {found.cost:.3f} of the first"
    left = "" if found.left is None else f", {found.left:.0f} s left"
    say_progress(f"{found.ended} of at most {found.trials} trials{best}{left}")


def _cancel(options: Namespace) -> int:
    with open_client(options) as client:
        found = client.experiments.cancel(options.name)
    say(f"{found.name} ends after the trials that run; {found.ended} are kept.")
    return 0


def _opened(name: str) -> "Results":
    """Return the results of an experiment, for a `with` block."""
    from station.trials.results import Results, file_of

    return Results.open(file_of(name))


def _metric(options: Namespace) -> str | None:
    return options.metric[0] if options.metric else None


_ACTIONS: dict[str, tuple[Callable[[Namespace], int], int, int]] = {
    "list": (_list, 0, 0),
    "show": (_show, 1, 1),
    "plot": (_plot, 2, 2),
    "best": (_best, 1, 1),
    "apply": (_apply, 1, 2),
    "replay": (_replay, 1, 2),
    "export": (_export, 2, 2),
    "compare": (_compare, 2, 2),
    "watch": (_watch, 1, 1),
    "cancel": (_cancel, 1, 1),
}
"""Function of each action, and the smallest and largest number of its words."""
