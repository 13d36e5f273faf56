"""Watch the measured state of an arm: a quick check of every cycle.

The quickest check adds up speeds and deviations of the joints: no point of the arm can
be faster, or further away, than if all joints turned about the same axis. An arm that
moves quickly fails it; its end effector is computed then.
"""

from collections.abc import Iterable, Sequence

from station.core.franka.joint_memory import JointMemory
from station.core.numerics.arm_chain import (
    new_links,
    place_links,
    twist_of,
    zero_jacobian,
)
from station.core.numerics.rigid_motion import compose, rotation_between
from station.memory.doubles import Doubles, own, zeros
from station.memory.functions import square_root

_CERTAIN = 1.0 - 1e-9
"""What is below this share of a limit is below the limit, however it is rounded."""


class JointWatch:
    """Finds out quickly whether the readings of n joints are certainly in order.

    Args:
        memory: State of the joints.
        chain: The arm's chain of n joints, see `arm_chain`.
        tool: Pose of the end effector in the flange's frame, 16 numbers; kept.
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
        chain: Doubles,
        tool: Doubles,
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
        self.chain = own(chain)
        self.tool = tool
        self.links = new_links(chain)
        self.flange = self.links[16 * self.size :]
        self.pose = zeros(16)
        self.desired = zeros(16)
        self.jacobian = zeros(6 * self.size)
        self.twist = zeros(6)
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
            position, speed, torque = q[i], dq[i], tau[i]
            # Without the two calls that `abs` is where this is interpreted.
            if speed < 0.0:
                speed = -speed
            if torque < 0.0:
                torque = -torque
            if not (
                lower[i] <= position <= upper[i]
                and speed <= fastest[i]
                and torque <= largest[i]
            ):
                is_good = False
            total += speed
            power += speed * torque
            if is_following:
                away += abs(position - q_d[i])
        self.total_power = power
        self.room -= total * self.reach_in_a_cycle
        if not is_good or not self.room > 0.0:
            return False
        if not power < self.power:
            return False
        is_slow = total * self.reach < self.speed
        is_close = not is_following or not (
            away * self.reach > self.translation
            or away > self.rotation
            or away > self.elbow
        )
        if is_slow and is_close:
            return True
        self.place(q, self.pose)
        return (is_slow or self.is_slow()) and (is_close or self.is_close())

    def is_slow(self) -> bool:
        """Return whether the end effector, which `place` has placed, is slow enough."""
        zero_jacobian(self.links, self.pose, self.jacobian)
        twist_of(self.jacobian, self.memory.dtheta, self.twist)
        return _length(self.twist) < _CERTAIN * self.speed

    def is_close(self) -> bool:
        """Return whether the placed end effector is close to the desired motion."""
        memory, pose, desired = self.memory, self.pose, self.desired
        if not abs(memory.positions[2] - memory.q_d[2]) < _CERTAIN * self.elbow:
            return False
        self.place(memory.q_d, desired)
        way = self.twist
        for i in range(3):
            way[i] = desired[12 + i] - pose[12 + i]
        if not _length(way) < _CERTAIN * self.translation:
            return False
        rotation_between(pose, desired, way)
        return _length(way) < _CERTAIN * self.rotation

    def place(self, q: Doubles, pose: Doubles) -> None:
        """Write the poses of the links, and the one of the end effector to `pose`."""
        place_links(self.chain, q, self.links)
        compose(self.flange, self.tool, pose)


def _length(vector: Doubles) -> float:
    x, y, z = vector[0], vector[1], vector[2]
    return square_root(x * x + y * y + z * z)
