"""What a controller did in a cycle: columns of doubles, packed once a cycle."""

from collections.abc import Sequence

import cython

from station.kernel.copying import copy_into
from station.kernel.doubles import Doubles, zeros

if cython.compiled:
    from cython.cimports.cpython.bytes import PyBytes_FromStringAndSize

PackedColumns = tuple[float, bytes, int]
"""Station time [s], the columns one after the other as doubles of the machine, and the
length n of each of the first four."""


class Column:
    """A column, shape (n,); `values` are the controller's own."""

    def __init__(self, values: Doubles) -> None:
        self.values = values
        self.size = len(values)


class SampleColumns:
    """Packs the columns of a controller. Control thread only, but for `newest`.

    Args:
        columns: Desired values, measurements, errors and commands, shape (n,) each,
            then whatever the controller adds.

    Attributes:
        newest: What was packed last; None before the first time. Any thread.
    """

    def __init__(self, columns: Sequence[Doubles]) -> None:
        self.views = tuple(columns)
        self.columns = [Column(view) for view in columns]
        self.size = len(columns[0])
        self.row = zeros(sum(len(view) for view in columns))
        self.width = len(self.row)
        self.newest: PackedColumns | None = None

    def keep(self, stamp: float) -> None:
        """Pack the columns.

        Args:
            stamp: Station time [s].
        """
        if cython.compiled:
            at = 0
            for column in self.columns:
                copy_into(self.row, at, column.values, column.size)
                at += column.size
            text = cython.cast(cython.p_char, cython.address(self.row[0]))
            self.newest = (
                stamp,
                PyBytes_FromStringAndSize(text, 8 * self.width),
                self.size,
            )
        else:
            self.newest = (stamp, b"".join(self.views), self.size)
