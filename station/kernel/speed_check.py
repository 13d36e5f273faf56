"""Whether all velocities of a simulation are possible and within their limits."""

from station.kernel.at_once import are_within
from station.kernel.doubles import Doubles


class SpeedCheck:
    """Compares velocities with their limits.

    Args:
        velocities: The velocities [rad/s or m/s], shape (n,).
        shares: Inverse of the limit of each velocity, shape (n,).
    """

    def __init__(self, velocities: Doubles, shares: Doubles) -> None:
        self.velocities = velocities
        self.shares = shares
        self.size = len(velocities)

    def holds(self) -> bool:
        """Return whether every velocity is certainly a number within its limit."""
        return are_within(self.velocities, self.shares, self.size)
