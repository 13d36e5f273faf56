"""The last cycles of an arm, kept in a ring for the report of an error."""

from station.memory.doubles import Doubles, own_zeros, zeros
from station.memory.vectors import copy_into

# As many as libfranka keeps by default.
CAPACITY = 50
"""Number of cycles kept."""
COMMAND = 16
"""Largest number of values in a command."""


class CycleLog:
    """Keeps time, state and command of the last cycles. No allocation.

    Args:
        states: State of the joints: quantities that lie side by side, shape (k n,).
        size: Number n of joints.

    Attributes:
        count: Number of cycles noted since the last `clear`.
        command: Memory that begins with the last command, of at most `COMMAND` doubles.
        command_size: Number of values in it.
    """

    def __init__(self, states: Doubles, size: int) -> None:
        self.states = states
        self.size = size
        self.capacity = CAPACITY
        self.command = own_zeros(COMMAND)
        self.command_size = 0
        self.width = 1 + len(states)
        self.rows = zeros(CAPACITY * self.width)
        self.commands = own_zeros(CAPACITY * COMMAND)
        self.command_sizes = own_zeros(CAPACITY)
        self.count = 0

    def clear(self) -> None:
        """Forget all cycles."""
        self.count = 0

    def note(self, time: float) -> None:
        """Keep this cycle.

        Args:
            time: Time of the arm [s].
        """
        place = self.count % self.capacity
        start = place * self.width
        self.rows[start] = time
        copy_into(self.rows, start + 1, self.states, self.width - 1)
        command = self.command
        copy_into(self.commands, place * COMMAND, command, len(command))
        self.command_sizes[place] = self.command_size
        self.count += 1

    def cycles(self) -> list[tuple[float, list[list[float]], list[float]]]:
        """Return time, the k quantities and the command, oldest cycle first."""
        found = []
        for number in range(max(0, self.count - CAPACITY), self.count):
            place = number % CAPACITY
            start = place * self.width
            row = [self.rows[i] for i in range(start, start + self.width)]
            firsts = range(1, self.width, self.size)
            state = [row[first : first + self.size] for first in firsts]
            first = place * COMMAND
            last = first + int(self.command_sizes[place])
            command = [self.commands[i] for i in range(first, last)]
            found.append((row[0], state, command))
        return found
