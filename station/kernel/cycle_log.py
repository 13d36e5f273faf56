"""The last cycles of an arm, kept in a ring for the report of an error."""

from station.kernel.at_once import copy_into
from station.kernel.doubles import own_zeros, zeros
from station.kernel.joint_memory import JointMemory

CAPACITY = 50
"""Number of cycles kept."""
COMMAND = 16
"""Largest number of values in a command."""


class CycleLog:
    """Keeps time, state and command of the last cycles. No allocation.

    Args:
        memory: State of the joints.

    Attributes:
        count: Number of cycles noted since the last `clear`.
        command: The last command, in the first `command_size` places.
        command_size: Number of values in it.
    """

    def __init__(self, memory: JointMemory) -> None:
        self.memory = memory
        self.size = memory.size
        self.capacity = CAPACITY
        self.command = own_zeros(COMMAND)
        self.command_size = 0
        self.width = 1 + 5 * self.size
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
        memory, rows, size = self.memory, self.rows, self.size
        place = self.count % self.capacity
        start = place * self.width
        rows[start] = time
        start += 1
        copy_into(rows, start, memory.q, size)
        copy_into(rows, start + size, memory.dq, size)
        copy_into(rows, start + 2 * size, memory.tau_J, size)
        copy_into(rows, start + 3 * size, memory.q_d, size)
        copy_into(rows, start + 4 * size, memory.tau_J_d, size)
        copy_into(self.commands, place * COMMAND, self.command, COMMAND)
        self.command_sizes[place] = self.command_size
        self.count += 1

    def cycles(self) -> list[tuple[float, list[list[float]], list[float]]]:
        """Return time, (q, dq, tau_J, q_d, tau_J_d) and command, oldest cycle first."""
        found = []
        size = self.size
        for number in range(max(0, self.count - CAPACITY), self.count):
            place = number % CAPACITY
            start = place * self.width
            row = [self.rows[i] for i in range(start, start + self.width)]
            state = [row[1 + i * size : 1 + (i + 1) * size] for i in range(5)]
            first = place * COMMAND
            last = first + int(self.command_sizes[place])
            command = [self.commands[i] for i in range(first, last)]
            found.append((row[0], state, command))
        return found
