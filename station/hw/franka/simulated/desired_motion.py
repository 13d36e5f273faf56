"""The desired joint motion inside an arm: q_d, dq_d and ddq_d."""

from collections.abc import Iterable

from station.core.franka.joint_memory import JointMemory
from station.memory.doubles import own, own_zeros, put
from station.memory.vectors import any_of, copy_into


class DesiredMotion:
    """Desired positions, velocities and accelerations of n joints.

    Exactly one of `hold`, `extrapolate`, `follow_positions` and `follow_velocities` is
    called per cycle. All of them start from the present desired motion, so q_d only
    jumps if a commanded position does.

    Args:
        memory: The joints; `q_d`, `dq_d` and `ddq_d` change in place.
        lower: Lower position limits [rad], shape (n,).
        upper: Upper position limits [rad], shape (n,).
        deceleration: Deceleration of `hold`, > 0 [rad/s^2], shape (n,).
        period: Duration of a cycle [s], > 0.

    Attributes:
        rests: Whether all desired velocities and accelerations are known to be zero.
    """

    def __init__(
        self,
        memory: JointMemory,
        *,
        lower: Iterable[float],
        upper: Iterable[float],
        deceleration: Iterable[float],
        period: float,
    ) -> None:
        self.memory = memory
        self.size = memory.size
        self.lower = own(lower)
        self.upper = own(upper)
        self.largest_step = own([a * period for a in deceleration])
        self.period = period
        self.wanted = own_zeros(self.size)
        self.rests = False

    def is_at_rest(self) -> bool:
        """Return whether all desired velocities are zero."""
        return not any_of(self.memory.dq_d, self.size)

    def seed(self, q: Iterable[float], dq: Iterable[float]) -> None:
        """Continue from another motion, e.g. the measured motion.

        Args:
            q: Positions [rad], shape (n,).
            dq: Velocities [rad/s], shape (n,).
        """
        self.rests = False
        put(self.memory.q_d, q)
        put(self.memory.dq_d, dq)
        put(self.memory.ddq_d, [0.0] * self.size)

    def hold(self) -> None:
        """Slow down to rest, then hold the positions."""
        if self.rests:
            return
        dq_d, ddq_d = self.memory.dq_d, self.memory.ddq_d
        # Both, because the acceleration of the last braking step must become 0, too.
        if not any_of(dq_d, self.size) and not any_of(ddq_d, self.size):
            self.rests = True
            return
        wanted, largest_step = self.wanted, self.largest_step
        for i in range(self.size):
            velocity, step = dq_d[i], largest_step[i]
            if velocity > step:
                wanted[i] = velocity - step
            elif velocity < -step:
                wanted[i] = velocity + step
            else:
                wanted[i] = 0.0
        self.move()

    def extrapolate(self) -> None:
        """Continue with constant acceleration, because no command has arrived."""
        wanted, period = self.wanted, self.period
        dq_d, ddq_d = self.memory.dq_d, self.memory.ddq_d
        for i in range(self.size):
            wanted[i] = dq_d[i] + ddq_d[i] * period
        self.move()

    def follow_velocities(self) -> None:
        """Move with the velocities in `target`; at a limit a joint stops."""
        copy_into(self.wanted, 0, self.memory.target, self.size)
        self.move()

    def move(self) -> None:
        """Move with the velocities in `wanted`; at a limit a joint stops."""
        self.rests = False
        period, dq, memory = self.period, self.wanted, self.memory
        positions, velocities = memory.q_d, memory.dq_d
        accelerations = memory.ddq_d
        lower, upper = self.lower, self.upper
        for i in range(self.size):
            last = positions[i]
            velocity = dq[i]
            reached = velocity
            position = last + velocity * period
            # A joint beyond its limit may stay or come back; otherwise it could never
            # return to its range.
            if position > upper[i] and velocity > 0.0:
                position = upper[i]
                if last > position:
                    position = last
                reached = 0.0
            elif position < lower[i] and velocity < 0.0:
                position = lower[i]
                if last < position:
                    position = last
                reached = 0.0
            accelerations[i] = (reached - velocities[i]) / period
            velocities[i] = reached
            positions[i] = position

    def follow_positions(self) -> None:
        """Go to the positions in `target` within this cycle.

        Velocities and accelerations are backward differences.
        """
        self.rests = False
        period, memory = self.period, self.memory
        positions, velocities = memory.q_d, memory.dq_d
        accelerations, q = memory.ddq_d, memory.target
        for i in range(self.size):
            position = q[i]
            velocity = (position - positions[i]) / period
            accelerations[i] = (velocity - velocities[i]) / period
            velocities[i] = velocity
            positions[i] = position
