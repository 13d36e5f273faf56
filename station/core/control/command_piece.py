"""Commands that lie side by side, with a copy of them: in a list or in doubles."""

from typing import TypeAlias

from station.core.faults import CONTAINED
from station.kernel.command_pieces import CommandPiece, Piece
from station.kernel.doubles import Storage

_FLOAT = {float}


class ListPiece(Piece):
    """Commands in a list, which may hold anything that somebody writes into it.

    Args:
        storage: The list.
        piece: Which of its elements.

    Attributes:
        storage: As given.
        start: Index of the first command in the storage.
        values: The copy, a list that is changed in place.
    """

    def __init__(self, storage: list[float], piece: slice) -> None:
        self.storage = storage
        self.start: int = piece.start
        self.values = storage[piece]
        self._piece = piece

    def take(self) -> bool:
        """Copy the commands; return whether they certainly are finite floats."""
        values = self.values
        values[:] = self.storage[self._piece]
        # The types first: the sum of a complex number or of a decimal raises, or
        # passes every comparison with a float. An overflow of the sum alone is no bad
        # command: whoever gets False looks again.
        return set(map(type, values)) == _FLOAT and not (total := sum(values)) - total

    def differs(self) -> bool:
        """Return whether commands are not those that were copied."""
        try:
            return self.storage[self._piece] != self.values
        except CONTAINED:  # e.g. an array: its comparison has no truth value
            return True

    def write(self) -> None:
        """Write the copied commands."""
        self.storage[self._piece] = self.values


KeptPiece: TypeAlias = ListPiece | CommandPiece


def make_piece(storage: Storage, piece: slice) -> KeptPiece:
    """Return the commands at `piece` of a storage, with a copy of what they are now."""
    if isinstance(storage, list):
        return ListPiece(storage, piece)
    return CommandPiece(storage, piece.start, piece.stop - piece.start)
