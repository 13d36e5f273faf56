"""What the last cycles left behind, in memory that is made once.

Each cycle has a row of doubles: number of the cycle, epoch, station time [s], period
[s], then the states of the joints, then the samples of controllers. Nothing is made or
freed in a cycle, and the cycle touches few lines of the processor's cache.
"""

from collections.abc import Sequence

from station.core.control.sample_columns import SampleColumns
from station.memory.doubles import Doubles, zeros
from station.memory.vectors import copy_into

HEAD = 4
"""Numbers of a row before the states of the joints."""
_HEAD = HEAD
_NAN = float("nan")

Layout = tuple[tuple[str, int, int, int], ...]
"""Where the samples are in a row: name of the controller, index of the sample, how many
doubles it has, and the length n of each of its first four columns. A sample begins with
its station time, which the columns follow. The index is -1 if it is an object."""


class StatePiece:
    """States of joints that lie side by side."""

    def __init__(self, values: Doubles) -> None:
        self.values = values
        self.size = len(values)


class Records:
    """The rows of the last cycles, in a ring: one writer, any number of readers.

    A reader looks at `newest`, then at what is kept of a cycle, and at the row last: it
    is whole if its first number is still that of the cycle.

    Args:
        capacity: How many are kept, >= 2.

    Attributes:
        capacity: As given.
        newest: Number of the newest cycle, 0 before the first one.
        width: Doubles in a row.
        states: Doubles of the joint states in a row.
        room: Doubles for samples in a row.
        memory: The rows; a cycle is at its number modulo the capacity.
        modes: The robot's mode in each cycle.
        layouts: The layout of the samples in each row.
        objects: Samples that are objects, by name; None in a cycle without any.
    """

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self.modes: list[str] = [""] * capacity
        self.layouts: list[Layout] = [()] * capacity
        self.objects: list[dict[str, object] | None] = [None] * capacity
        self.pieces: list[StatePiece] = []
        self.prepare([], 0)

    def prepare(self, pieces: Sequence[Doubles], room: int) -> None:
        """Forget all cycles, and make memory for others.

        Args:
            pieces: Where the states of the joints are read, one after the other.
            room: How many doubles samples may take.
        """
        self.pieces = [StatePiece(piece) for piece in pieces]
        self.states = sum(len(piece) for piece in pieces)
        self.room = room
        self.width = _HEAD + self.states + room
        self.memory = zeros(self.capacity * self.width)
        self.rows = self.memory
        self.newest = 0

    def begin(
        self, cycle: int, epoch: int, time: float, period: float, mode: str
    ) -> int:
        """Begin the next row; control thread only, cycles without gaps.

        Args:
            cycle: Number of the cycle.
            epoch: The station's epoch.
            time: Station time [s].
            period: Time since the last cycle [s].
            mode: The robot's mode.

        Returns:
            Where samples go in `rows`.
        """
        slot = cycle % self.capacity
        at = slot * self.width
        rows = self.rows
        rows[at] = 0.0  # nobody takes the row for whole
        self.modes[slot] = mode
        rows[at + 1] = epoch
        rows[at + 2] = time
        rows[at + 3] = period
        at += _HEAD
        for piece in self.pieces:
            copy_into(rows, at, piece.values, piece.size)
            at += piece.size
        return at

    def add(self, at: int, sampled: SampleColumns, is_there: bool) -> None:  # noqa: FBT001 - a C function
        """Write a sample to its place in `rows`; its time is NaN if it is not there."""
        copy_into(self.rows, at, sampled.row, sampled.width)
        if not is_there:
            self.rows[at] = _NAN

    def end(
        self, cycle: int, layout: Layout, objects: dict[str, object] | None
    ) -> None:
        """End the row: it is whole.

        Args:
            cycle: Number of the cycle.
            layout: Where its samples are.
            objects: Those that are objects.
        """
        slot = cycle % self.capacity
        self.layouts[slot] = layout
        self.objects[slot] = objects
        self.rows[slot * self.width] = cycle
        self.newest = cycle
