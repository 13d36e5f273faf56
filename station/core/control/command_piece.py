"""Commands that lie side by side, with a copy of them: in a list or in doubles."""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from typing_extensions import override

from station.core.control.command_pieces import CommandPiece, Piece
from station.core.faults import CONTAINED
from station.core.hardware.slots import Slot, SlotRun, side_by_side

_FLOAT = {float}


class ListPiece(Piece):
    """Commands in a list, which may hold anything that somebody writes into it.

    Args:
        storage: The list.
        piece: Which of its elements.
        slots: Where each of them is.

    Attributes:
        storage: As given.
        slots: As given.
        values: The copy, a list that is changed in place.
    """

    def __init__(
        self, storage: list[float], piece: slice, slots: Sequence[Slot]
    ) -> None:
        self.storage = storage
        self.slots = slots
        self.values = storage[piece]
        self._piece = piece

    @override
    def take(self) -> bool:
        """Copy the commands; return whether they certainly are finite floats."""
        values = self.values
        values[:] = self.storage[self._piece]
        # The types first: the sum of a complex number or of a decimal raises, or
        # passes every comparison with a float. An overflow of the sum alone is no bad
        # command: whoever gets False looks again.
        return set(map(type, values)) == _FLOAT and not (total := sum(values)) - total

    @override
    def differs(self) -> bool:
        """Return whether commands are not those that were copied."""
        try:
            return self.storage[self._piece] != self.values
        except CONTAINED:  # e.g. an array: its comparison has no truth value
            return True

    @override
    def write(self) -> None:
        """Write the copied commands."""
        self.storage[self._piece] = self.values


KeptPiece: TypeAlias = ListPiece | CommandPiece


def make_pieces(slots: Iterable[Slot]) -> list[KeptPiece]:
    """Return the commands in some slots, with a copy of what they are now."""
    return [_make_piece(run) for run in side_by_side(slots)]


def _make_piece(run: SlotRun) -> KeptPiece:
    if isinstance(run.storage, list):
        return ListPiece(run.storage, slice(run.begin, run.end), run.slots)
    return CommandPiece(run.storage[run.begin : run.end], run.slots)
