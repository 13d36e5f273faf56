"""Quick checks of commanded motions and torques against the limits of an arm.

They answer "certainly fine" or "look closer"; whoever looks closer finds the error.
"""

from collections.abc import Iterable

from station.core.franka.joint_memory import JointMemory
from station.memory.doubles import Storage, own, own_zeros


class CommandCheck:
    """Compares the commands of n joints with their limits.

    Args:
        memory: State and commands of the joints.
        lower: Lowest positions [rad], shape (n,).
        upper: Highest positions [rad].
        velocity: Largest speeds [rad/s].
        acceleration: Largest accelerations [rad/s^2].
        jerk: Largest jerks [rad/s^3].
        torque_rate: Largest rate of the torques [Nm/s].
        period: Duration of a cycle [s], > 0.
    """

    def __init__(
        self,
        memory: JointMemory,
        *,
        lower: Iterable[float],
        upper: Iterable[float],
        velocity: Iterable[float],
        acceleration: Iterable[float],
        jerk: Iterable[float],
        torque_rate: float,
        period: float,
    ) -> None:
        self.lower = own(lower)
        self.upper = own(upper)
        self.velocity = own(velocity)
        self.acceleration = own(acceleration)
        self.jerk = own(jerk)
        # With room for the rounding of a difference.
        self.torque_step = torque_rate * period * (1.0 + 1e-9)
        self.period = period
        self.reached = own_zeros(memory.size)
        self.memory = memory
        self.size = memory.size

    def admit_positions(self) -> bool:
        """Return whether the positions in `target` are certainly within the limits."""
        memory, period = self.memory, self.period
        q, dq, q_d = memory.target, memory.target_dq, memory.q_d
        for i in range(self.size):
            dq[i] = (q[i] - q_d[i]) / period
        return self.admit(q, dq)

    def admit_velocities(self) -> bool:
        """Return whether the velocities in `target` are certainly within the limits."""
        memory, period, q = self.memory, self.period, self.reached
        dq, q_d = memory.target, memory.q_d
        for i in range(self.size):
            q[i] = q_d[i] + dq[i] * period
        return self.admit(q, dq)

    def admit(self, q: Storage, dq: Storage) -> bool:
        """Return whether a step of a joint motion is certainly within the limits.

        Args:
            q: Next positions [rad], shape (n,).
            dq: Velocities that lead there [rad/s].
        """
        last_dq, last_ddq = self.memory.dq_d, self.memory.ddq_d
        lower, upper, fastest = self.lower, self.upper, self.velocity
        rates, jerks, period = self.acceleration, self.jerk, self.period
        for i in range(self.size):
            velocity, rate, jerk = dq[i], rates[i], jerks[i]
            acceleration = (velocity - last_dq[i]) / period
            if not (
                lower[i] <= q[i] <= upper[i]
                and -fastest[i] <= velocity <= fastest[i]
                and -rate <= acceleration <= rate
                and -jerk <= (acceleration - last_ddq[i]) / period <= jerk
            ):
                return False
        return True

    def admit_torques(self) -> bool:
        """Return whether the commanded torques are certainly within the rate limit."""
        tau, last = self.memory.torques, self.memory.tau_J_d
        largest = self.torque_step
        lowest = -largest
        for i in range(self.size):
            if not lowest <= tau[i] - last[i] <= largest:
                return False
        return True
