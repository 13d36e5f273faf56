"""Commands of a robot in flat memory: copied, checked, compared and written anew."""

from collections.abc import Callable, Sequence
from typing import Any

import cython

from station.memory.doubles import Doubles, zeros
from station.memory.vectors import are_finite, copy_into, differ


class Piece:
    """Some commands, and a copy of them."""

    def take(self) -> bool:
        """Copy the commands; return whether all of them certainly are finite."""
        raise NotImplementedError

    def differs(self) -> bool:
        """Return whether a command is not what was copied."""
        raise NotImplementedError

    def write(self) -> None:
        """Write the copied commands."""
        raise NotImplementedError


class CommandPiece(Piece):
    """Commands that lie side by side, and a copy of them.

    Args:
        memory: The commands, shape (n,).
        slots: Where whoever writes one of them finds it; kept for reports.

    Attributes:
        slots: As given.
        values: The copy, shape (n,).
    """

    def __init__(self, memory: Doubles, slots: Sequence[Any] = ()) -> None:
        self.slots = slots
        self.memory = memory
        self.size = len(memory)
        self.values = zeros(self.size)
        self.take()

    def take(self) -> bool:
        """Copy the commands; return whether all of them certainly are finite."""
        if cython.compiled:
            copy_into(self.values, 0, self.memory, self.size)
        else:
            self.values[:] = self.memory
        return are_finite(self.values, self.size)

    def differs(self) -> bool:
        """Return whether a command is not what was copied."""
        if cython.compiled:
            return differ(self.memory, self.values, self.size)
        return self.memory != self.values

    def write(self) -> None:
        """Write the copied commands."""
        if cython.compiled:
            copy_into(self.memory, 0, self.values, self.size)
        else:
            self.memory[:] = self.values


class CommandPieces:
    """Several pieces that are kept as they were copied.

    Args:
        pieces: The pieces.
        report: Called with a piece that differs, before it is written.
    """

    def __init__(
        self,
        pieces: list[Piece],
        report: Callable[[Any], None] | None = None,
    ) -> None:
        self.pieces = pieces
        self.report = report
        self.next = 0

    def keep(self) -> None:
        """Compare one piece, the next one each time, and write all of them anew.

        Also what equals the copy is written: it may still be no float, e.g. 0j.
        """
        place = self.next
        if place < len(self.pieces):
            piece = self.pieces[place]
            if self.report is not None and piece.differs():
                self.report(piece)
        self.next = place + 1 if place + 1 < len(self.pieces) else 0
        for one in self.pieces:
            one.write()
