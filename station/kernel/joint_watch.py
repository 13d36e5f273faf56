"""Watch the measured state of an arm: a quick check of every cycle."""

from collections.abc import Iterable, Sequence

from station.kernel.doubles import own
from station.kernel.joint_memory import JointMemory


class JointWatch:
    """Finds out quickly whether the readings of n joints are certainly in order.

    Args:
        memory: State of the joints.
        lower: Lowest positions [rad], shape (n,).
        upper: Highest positions [rad].
        velocity: Largest speeds [rad/s].
        torque: Largest torques [Nm].
        reach: Larger than the distance of any point of the arm from any axis [m].
        speed: Largest speed of the end effector [m/s].
        power: Largest sum of the mechanical powers of the joints [W].
        deviation: Largest distances of the end effector [m], of its orientation [rad]
            and of the elbow [rad] from the desired motion.
        period: Duration of a cycle [s], > 0.

    Attributes:
        room: How far a point of the arm may still move until a distance may have become
            too short [m].
        total_power: Sum of the mechanical powers at the last look, all positive [W].
    """

    def __init__(
        self,
        memory: JointMemory,
        *,
        lower: Iterable[float],
        upper: Iterable[float],
        velocity: Iterable[float],
        torque: Iterable[float],
        reach: float,
        speed: float,
        power: float,
        deviation: Sequence[float],
        period: float,
    ) -> None:
        self.memory = memory
        self.size = memory.size
        self.lower = own(lower)
        self.upper = own(upper)
        self.velocity = own(velocity)
        self.torque = own(torque)
        self.reach = reach
        self.reach_in_a_cycle = reach * period
        self.speed = speed
        self.power = power
        self.translation = deviation[0]
        self.rotation = deviation[1]
        self.elbow = deviation[2]
        self.room = 0.0
        self.total_power = 0.0

    def is_quiet(self, is_following: bool) -> bool:  # noqa: FBT001 - a C function
        """Look at all joints, and count down the room.

        Args:
            is_following: Whether the arm follows the desired motion.

        Returns:
            Whether everything is certainly in order. Otherwise somebody must look
            closer.
        """
        memory = self.memory
        q, dq, tau, q_d = memory.positions, memory.dtheta, memory.tau_J, memory.q_d
        lower, upper = self.lower, self.upper
        fastest, largest = self.velocity, self.torque
        total = 0.0
        power = 0.0
        away = 0.0
        is_good = True
        for i in range(self.size):
            position, velocity, torque = q[i], dq[i], tau[i]
            if not (
                lower[i] <= position <= upper[i]
                and -fastest[i] <= velocity <= fastest[i]
                and -largest[i] <= torque <= largest[i]
            ):
                is_good = False
            total += abs(velocity)
            power += abs(velocity * torque)
            away += abs(position - q_d[i])
        self.total_power = power
        self.room -= total * self.reach_in_a_cycle
        if not is_good or not self.room > 0.0:
            return False
        if not total * self.reach < self.speed or not power < self.power:
            return False
        return not is_following or not (
            away * self.reach > self.translation
            or away > self.rotation
            or away > self.elbow
        )
