"""Draw an experiment as a PNG picture."""

from collections.abc import Sequence
from pathlib import Path
from posixpath import commonpath

import numpy as np
from matplotlib.figure import Figure

from station.experiments.trial_world import TrialWorld
from station.trials.analysis import ranked
from station.trials.errors import ExperimentError
from station.trials.metrics import UNITS
from station.trials.results import Results, Row

KINDS = ("parallel", "pareto", "responses")


def plot(results: Results, kind: str, path: Path, metrics: Sequence[str] = ()) -> None:
    """Draw an experiment.

    Args:
        results: The experiment.
        kind: `parallel`: a line per trial through its parameters and metrics; `pareto`:
            two metrics, with the trials that no other trial beats in both; `responses`:
            the error of the best, median and worst trial over time.
        path: The `.png` file.
        metrics: Metrics that rank the trials: `parallel` and `responses` use the first,
            `pareto` the first two; empty for `rms_error` and `effort_rms`.

    Raises:
        ExperimentError: Nothing can be drawn, or the file cannot be written.
        UnknownParameterError: There is no such metric.
    """
    chosen = [*metrics, *("rms_error", "effort_rms")[len(metrics) :]]
    rows = ranked(results, chosen[0])
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    if kind == "parallel":
        _parallel(figure, rows, chosen)
    elif kind == "pareto":
        _pareto(figure, rows, chosen)
    else:
        _responses(figure, results, rows)
    try:
        figure.savefig(path, format="png", dpi=120)
    except OSError as error:
        raise ExperimentError(f"{path} cannot be written: {error}.") from error


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Return the indices of the points that no other beats in both numbers.

    Args:
        points: Pairs of numbers; smaller is better.
    """
    order = sorted(range(len(points)), key=lambda index: points[index])
    front: list[int] = []
    lowest = float("inf")
    for index in order:
        if points[index][1] < lowest:
            lowest = points[index][1]
            front.append(index)
    return front


def _parallel(figure: Figure, rows: Sequence[Row], metrics: Sequence[str]) -> None:
    names = sorted({name for row in rows for name in row.parameters})
    columns = [[row.parameters.get(name, np.nan) for row in rows] for name in names]
    columns += [[row.result.metrics.get(m, np.nan) for row in rows] for m in metrics]
    axes = figure.subplots()
    shares = []
    for column in columns:
        low, high = np.nanmin(column), np.nanmax(column)
        shares.append((np.array(column) - low) / ((high - low) or 1.0))
    lines = np.array(shares).T  # (trials, columns), the best first
    for place, line in reversed(list(enumerate(lines))):
        share = place / max(1, len(lines) - 1)
        axes.plot(line, color=(share, 0.3, 1.0 - share), alpha=0.5, linewidth=0.8)
    # Names of gains are long and begin alike, so leave out the common beginning.
    folder = commonpath(names) if len(names) > 1 else ""
    short = [name.removeprefix(f"{folder}/") for name in names]
    labels = [
        f"{name}\n{np.nanmin(column):.3g} … {np.nanmax(column):.3g}"
        for name, column in zip([*short, *metrics], columns, strict=True)
    ]
    axes.set_xticks(range(len(labels)), labels, rotation=60, ha="right", fontsize=7)
    axes.set_yticks([])
    title = f"{len(rows)} trials; blue is the best {metrics[0]}"
    axes.set_title(f"{title}\n{folder}/…" if folder else title)


def _pareto(figure: Figure, rows: Sequence[Row], metrics: Sequence[str]) -> None:
    one, other = metrics[:2]
    known = [row.result.metrics for row in rows if other in row.result.metrics]
    points = [(metric[one], metric[other]) for metric in known]
    front = [points[index] for index in pareto_front(points)]
    axes = figure.subplots()
    axes.plot(*np.array(points).T, ".", color="0.6", label="trials")
    axes.plot(*np.array(front).T, "o-", label="beaten by none in both")
    axes.set_xlabel(f"{one} [{UNITS[one]}]")
    axes.set_ylabel(f"{other} [{UNITS[other]}]")
    axes.legend()


def _responses(figure: Figure, results: Results, rows: Sequence[Row]) -> None:
    axes = figure.subplots()
    chosen = {"best": rows[0], "median": rows[len(rows) // 2], "worst": rows[-1]}
    with TrialWorld(results.setup) as world:
        for name, row in chosen.items():
            _, trace = world.record(results.trial(row.result.hash))
            if trace is None:
                continue
            error = np.sqrt(np.mean(trace.error**2, axis=1))
            axes.plot(trace.time, error, label=f"{name} {row.result.hash[:6]}")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("RMS of the joints' errors [rad or m]")
    axes.legend()
