"""A check that all numbers of some memory are finite."""

from station.memory.doubles import Doubles
from station.memory.vectors import are_finite


class FiniteCheck:
    """Looks for a number that is not finite.

    Args:
        memory: The numbers, shape (n,).
    """

    def __init__(self, memory: Doubles) -> None:
        self.memory = memory
        self.size = len(memory)

    def first_bad(self) -> int:
        """Return the index of the first number that is not finite; -1 for none."""
        memory, size = self.memory, self.size
        if are_finite(memory, size):
            return -1  # all are finite
        for i in range(size):
            value = memory[i]
            if value - value != 0.0:
                return i
        return -1
