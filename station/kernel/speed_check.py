"""Whether all velocities of a simulation are possible and within their limits."""

from station.kernel.doubles import Doubles


class SpeedCheck:
    """Compares velocities with their limits by one sum.

    Args:
        velocities: The velocities [rad/s or m/s], shape (n,).
        shares: Inverse of the limit of each velocity, shape (n,).
    """

    def __init__(self, velocities: Doubles, shares: Doubles) -> None:
        self.velocities = velocities
        self.shares = shares
        self.size = len(velocities)

    def holds(self) -> bool:
        """Return whether every velocity is certainly a number within its limit.

        The sum of the squares of velocity over limit is at most 1 only if each of them
        is and none is NaN. False alone does not mean that a limit is exceeded.
        """
        velocities, shares = self.velocities, self.shares
        total = 0.0
        for i in range(self.size):
            relative = velocities[i] * shares[i]
            total += relative * relative
        return total <= 1.0
