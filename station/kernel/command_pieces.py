"""Commands of a robot in flat memory: copied, checked, compared and written anew."""

from station.kernel.doubles import Doubles, zeros


class CommandPiece:
    """Commands that lie side by side, and a copy of them.

    Args:
        memory: The commands, shape (n,).

    Attributes:
        values: The copy, shape (n,).
    """

    def __init__(self, memory: Doubles) -> None:
        self.memory = memory
        self.size = len(memory)
        self.values = zeros(self.size)
        self.take()

    def take(self) -> bool:
        """Copy the commands; return whether all of them are finite."""
        memory, values = self.memory, self.values
        is_finite = True
        for i in range(self.size):
            value = memory[i]
            if value - value != 0.0:
                is_finite = False
            values[i] = value
        return is_finite

    def differs(self) -> bool:
        """Return whether a command is not what was copied."""
        memory, values = self.memory, self.values
        for i in range(self.size):
            if memory[i] != values[i]:
                return True
        return False

    def write(self) -> None:
        """Write the copied commands."""
        self.memory[:] = self.values


class CommandPieces:
    """Several pieces, written together.

    Args:
        pieces: The pieces.
    """

    def __init__(self, pieces: list[CommandPiece]) -> None:
        self.pieces = pieces

    def write(self) -> None:
        """Write the copied commands of all pieces."""
        for piece in self.pieces:
            piece.write()
