"""A recording as a table: CSV, NPZ for NumPy, Parquet."""

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from station.core.errors import RecordingRefusedError
from station.records.cdr import Values
from station.records.recording_reader import read_messages

FORMATS = ("mcap", "csv", "npz", "parquet")
Columns = dict[str, NDArray[np.float64]]
"""Columns of a table by name, shape (m,) each."""
_CYCLES = "/cycles"
_LEFT_OUT = frozenset({
    "header",
    "name",
    "mode",
    "current_errors",
    "last_motion_errors",
})


def columns(path: Path, topics: Iterable[str] | None = None) -> Columns:
    """Return a recording as columns with one row per cycle.

    A column is called after its channel, its field and what the number belongs to, e.g.
    `joint_states/position/panda_joint1`; `cycle`, `time`, `period` and `epoch` come
    first. Where a channel has no message in a cycle, its columns are NaN.

    Args:
        path: The file.
        topics: Which channels, `/cycles` among them; all when None.

    Raises:
        RecordingFileError: The file is no whole recording.
    """
    cycles: list[Values] = []
    rows: dict[int, int] = {}
    cells: dict[str, list[tuple[int, float]]] = {}
    waiting: list[tuple[int, str, Values]] = []
    for topic, message in read_messages(path, topics):
        stamp = _stamp(message)
        if topic == _CYCLES:
            rows[stamp] = len(cycles)
            cycles.append(message)
        elif stamp:
            waiting.append((stamp, topic, message))
    for stamp, topic, message in waiting:
        row = rows.get(stamp)
        if row is not None:
            for name, value in _numbers(topic.strip("/"), message):
                cells.setdefault(name, []).append((row, value))
    found: Columns = {
        name: np.array([one[name] for one in cycles], dtype=np.float64)
        for name in ("cycle", "time", "period", "epoch")
    }
    for name, entries in cells.items():
        column = np.full(len(cycles), np.nan)
        for row, value in entries:
            column[row] = value
        found[name] = column
    return found


def export(path: Path, target: Path, form: str) -> None:
    """Write a recording as a table.

    Args:
        path: The file of the recording.
        target: The file to be.
        form: `csv`, `npz` or `parquet`.

    Raises:
        RecordingFileError: The file is no whole recording.
        RecordingRefusedError: There is no such form.
        ModuleNotFoundError: Parquet needs the package pyarrow.
    """
    writers = {"csv": _write_csv, "npz": _write_npz, "parquet": _write_parquet}
    if form not in writers:
        raise RecordingRefusedError(
            f"A recording cannot be written as {form!r}.",
            remedy=f"There are: {', '.join(writers)}.",
        )
    writers[form](columns(path), target)


def _stamp(message: Values) -> int:
    """Return the stamp of a message [ns]; 0 for one that has none."""
    header = message.get("header")
    if header is None:
        return 0
    stamp = header["stamp"]
    return int(stamp["sec"]) * 1_000_000_000 + int(stamp["nanosec"])


def _numbers(prefix: str, message: Values) -> list[tuple[str, float]]:
    names = message.get("name", [])
    found: list[tuple[str, float]] = []
    for field, value in message.items():
        if field in _LEFT_OUT:
            continue
        if isinstance(value, list):
            elements = names if len(names) == len(value) else range(len(value))
            found += [
                (f"{prefix}/{field}/{element}", one)
                for element, one in zip(elements, value, strict=True)
            ]
        elif isinstance(value, int | float):
            found.append((f"{prefix}/{field}", float(value)))
    return found


def _write_csv(table: Mapping[str, NDArray[np.float64]], target: Path) -> None:
    with target.open("x", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        rows = zip(*(column.tolist() for column in table.values()), strict=True)
        writer.writerows(rows)


def _write_npz(table: Mapping[str, NDArray[np.float64]], target: Path) -> None:
    with target.open("xb") as file:
        np.savez_compressed(file, allow_pickle=False, **table)


def _write_parquet(table: Mapping[str, NDArray[np.float64]], target: Path) -> None:
    # Imported late: pyarrow is large, and comes with an extra of its own.
    import pyarrow
    from pyarrow import parquet

    with target.open("xb") as file:
        parquet.write_table(pyarrow.table(dict(table)), file)
