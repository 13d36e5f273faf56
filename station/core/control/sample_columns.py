"""A controller's sample of a cycle: columns of doubles, packed once a cycle."""

from collections.abc import Sequence
from math import isnan

import cython

from station.memory.doubles import Doubles, zeros
from station.memory.vectors import copy_into

PackedColumns = tuple[float, bytes, int]
"""Station time [s], the columns one after the other as doubles of the machine, and the
length n of each of the first four."""


class Column:
    """A column, shape (n,), over memory of the controller."""

    def __init__(self, values: Doubles) -> None:
        self.values = values
        self.size = len(values)


class SampleColumns:
    """Packs the columns of a controller. Control thread only, but for `newest`.

    Args:
        columns: Desired values, measurements, errors and commands, shape (n,) each,
            then whatever the controller adds.

    Attributes:
        row: Numbers packed last, shape (width,): station time [s], which is NaN before
            the first time, then the columns.
    """

    def __init__(self, columns: Sequence[Doubles]) -> None:
        self.stamp = zeros(1)
        self.views = (self.stamp, *columns)
        self.columns = [Column(view) for view in self.views]
        self.size = len(columns[0])
        self.row = zeros(sum(len(view) for view in self.views))
        self.packed = memoryview(self.row).cast("B")
        # NaN as station time tells readers that the row is empty.
        self.row[0] = float("nan")
        self.width = len(self.row)

    @property
    def newest(self) -> PackedColumns | None:
        """Return the sample packed last; None before the first. Any thread."""
        # Copied in one step: the control thread may pack the next columns meanwhile.
        packed = memoryview(self.row).tobytes()
        (stamp,) = memoryview(packed[:8]).cast("d")
        return None if isnan(stamp) else (stamp, packed[8:], self.size)

    def keep(self, stamp: float) -> None:
        """Pack the columns.

        Args:
            stamp: Station time [s].
        """
        self.stamp[0] = stamp
        if cython.compiled:
            at = 0
            for column in self.columns:
                copy_into(self.row, at, column.values, column.size)
                at += column.size
        else:
            # Written in one step, for readers in other threads.
            self.packed[:] = b"".join(self.views)
