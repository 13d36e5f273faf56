"""Export a recording as a table: CSV, NPZ (NumPy) or Parquet."""

import csv
import io
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from station.core.errors import RecordingRefusedError
from station.records.recording_table import Choice, RecordingTable

FORMATS = ("mcap", "csv", "npz", "parquet")
Columns = dict[str, NDArray[np.float64]]
"""Columns of a table by name, shape (m,) each; whole numbers are int64."""
_WHOLE = frozenset({"cycle", "epoch"})
_ROWS = 20
"""Rows in a piece of CSV, which then takes about a millisecond to make."""


def columns(path: Path, topics: Iterable[str] = ()) -> Columns:
    """Return a recording as columns with one row per cycle.

    The name of a column has the channel, the field, and the joint or axis, e.g.
    `joint_states/position/panda_joint1`; `cycle`, `time`, `period` and `epoch` come
    first. Where a channel has no message in a cycle, its columns are NaN.

    Args:
        path: The file.
        topics: Channels; all when empty.

    Raises:
        RecordingFileError: The file is not a complete recording.
    """
    return _columns(RecordingTable(path, Choice(channels=tuple(topics))))


def export(path: Path, target: Path, form: str, choice: Choice | None = None) -> None:
    """Write a recording as a table.

    Args:
        path: The file of the recording.
        target: The file to write, which must not exist.
        form: `csv`, `npz` or `parquet`.
        choice: Wanted part of the recording; all when None.

    Raises:
        RecordingFileError: The file is not a complete recording.
        RecordingRefusedError: The form is unknown, or the recording does not have a
            wanted channel or joint.
        ModuleNotFoundError: Parquet needs the package pyarrow.
    """
    writers = {"csv": _write_csv, "npz": _write_npz, "parquet": _write_parquet}
    if form not in writers:
        raise RecordingRefusedError(
            f"A recording cannot be written as {form!r}.",
            remedy=f"There are: {', '.join(writers)}.",
        )
    table = RecordingTable(path, choice)
    table.check()
    writers[form](table, target)


def csv_pieces(
    path: Path, choice: Choice, pause: Callable[[], None] = lambda: None
) -> Iterator[str]:
    """Return the text of a recording as CSV, piece by piece, its header first.

    Args:
        path: The file of the recording.
        choice: Wanted part of the recording.
        pause: Called between short pieces of work.

    Raises:
        RecordingFileError: The file is not a complete recording; raised before the
            first piece.
        RecordingRefusedError: The recording does not have the wanted channels or
            joints.
    """
    table = RecordingTable(path, choice, pause)
    # Check before the first piece: a later error would truncate an answer.
    table.check()
    return _csv_pieces(table)


def _csv_pieces(table: RecordingTable) -> Iterator[str]:
    buffer = io.StringIO()
    writer = csv.writer(buffer)
    writer.writerow(table.names)
    for number, row in enumerate(table.rows(), 1):
        writer.writerow(row)
        if number % _ROWS == 0:
            yield buffer.getvalue()
            # Reuse the buffer, so that a large table needs no more memory than a piece.
            buffer.seek(0)
            buffer.truncate()
    yield buffer.getvalue()


def _columns(table: RecordingTable) -> Columns:
    cells: list[array[Any]] = [
        array("q" if name in _WHOLE else "d") for name in table.names
    ]
    for row in table.rows():
        for column, value in zip(cells, row, strict=True):
            column.append(value)
    return {
        name: np.frombuffer(column, dtype=np.int64 if name in _WHOLE else np.float64)
        if len(column)
        else np.empty(0)
        for name, column in zip(table.names, cells, strict=True)
    }


def _write_csv(table: RecordingTable, target: Path) -> None:
    # Mode `x` never overwrites an existing file.
    with target.open("x", newline="", encoding="utf-8") as file:
        file.writelines(_csv_pieces(table))


def _write_npz(table: RecordingTable, target: Path) -> None:
    arrays: Mapping[str, NDArray[np.float64]] = _columns(table)
    with target.open("xb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def _write_parquet(table: RecordingTable, target: Path) -> None:
    # Imported late: pyarrow is large, and belongs to an extra.
    import pyarrow
    from pyarrow import parquet

    arrays = _columns(table)
    with target.open("xb") as file:
        parquet.write_table(pyarrow.table(dict(arrays)), file)
