"""Export results as tables for other programs."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from station.trials.errors import ExperimentError
from station.trials.results import Results

if TYPE_CHECKING:
    from pandas import DataFrame

_ABOUT = ("number", "hash", "state", "reason", "seed", "seconds", "worker")


def table(results: Results) -> list[dict[str, object]]:
    """Return a row per trial: its hash and state, its parameters, its metrics.

    The column of a parameter is named `parameter:NAME`; a metric that a trial lacks is
    None.
    """
    rows = results.rows()
    parameters = sorted({name for row in rows for name in row.parameters})
    metrics = list(dict.fromkeys(name for row in rows for name in row.result.metrics))
    return [
        {
            "number": row.number,
            "hash": row.result.hash,
            "state": row.result.state,
            "reason": row.result.reason,
            "seed": row.seed,
            "seconds": row.result.seconds,
            "worker": row.result.worker,
            **{f"parameter:{name}": row.parameters.get(name) for name in parameters},
            **{name: row.result.metrics.get(name) for name in metrics},
        }
        for row in rows
    ]


def data_frame(results: Results) -> "DataFrame":
    """Return `table` as a DataFrame of pandas, which must be installed."""
    from pandas import DataFrame

    return DataFrame(table(results))


def export(results: Results, path: Path) -> None:
    """Write the table as a `.csv` or `.parquet` file.

    Raises:
        ExperimentError: The file has another ending or cannot be written.
    """
    if path.suffix not in {".csv", ".parquet"}:
        raise ExperimentError(
            f"Results cannot be written as '{path.name}'.",
            remedy="Choose a name that ends in .csv or .parquet.",
        )
    try:
        if path.suffix == ".parquet":
            data_frame(results).to_parquet(path)
            return
        rows = table(results)
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0] if rows else _ABOUT)
            writer.writeheader()
            writer.writerows(rows)
    except OSError as error:
        raise ExperimentError(f"{path} cannot be written: {error}.") from error


def write_gains(gains: Mapping[str, Mapping[str, float]], path: Path) -> None:
    """Write gains, by controller and name, as a YAML file of a gain set.

    Raises:
        ExperimentError: The file cannot be written.
    """
    plain = {controller: dict(values) for controller, values in gains.items()}
    try:
        path.write_text(yaml.safe_dump({"gains": plain}), encoding="utf-8")
    except OSError as error:
        raise ExperimentError(f"{path} cannot be written: {error}.") from error
