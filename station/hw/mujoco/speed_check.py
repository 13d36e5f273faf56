"""Whether all velocities of a simulation are possible and within their limits."""

from math import hypot

import cython

from station.memory.doubles import Doubles
from station.memory.vectors import are_within


class SpeedCheck:
    """Compares velocities with their limits.

    Args:
        velocities: The velocities [rad/s or m/s], shape (n,).
        shares: Inverse of the limit of each velocity, >= 0, shape (n,); see
            `take_limits`.
    """

    def __init__(self, velocities: Doubles, shares: Doubles) -> None:
        self.velocities = velocities
        self.shares = shares
        self.size = len(velocities)
        self.slowest = 0.0
        self.take_limits()

    def take_limits(self) -> None:
        """Take over shares that have changed."""
        largest = max(self.shares, default=0.0)
        self.slowest = 1.0 / largest if largest > 0.0 else 0.0

    def holds(self) -> bool:
        """Return whether every velocity is certainly a number within its limit."""
        # Interpreted, the length of all velocities together is known in a third of the
        # time, and what rests or moves slowly is below every limit.
        if not cython.compiled and hypot(*self.velocities) < self.slowest:
            return True
        return are_within(self.velocities, self.shares, self.size)
