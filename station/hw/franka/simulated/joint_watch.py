"""Compare the measured state of an arm with its limits, in every cycle.

Speeds and deviations of the joints are summed up first: no point of the arm can be
faster, or farther away, than if all joints turned about the same axis. The end effector
is computed only if that sum exceeds its limits.
"""

from math import inf

from station.core.franka.joint_memory import JointMemory
from station.core.numerics.arm_chain import (
    new_links,
    place_links,
    twist_of,
    zero_jacobian,
)
from station.core.numerics.rigid_motion import compose, rotation_between
from station.hw.franka.arm.arm_limits import ArmLimits, SupervisorLimits
from station.hw.franka.arm.self_collision import link_distances
from station.hw.franka.arm.velocity_curves import VelocityCurves
from station.hw.franka.simulated.violations import (
    DEVIATION,
    END_EFFECTOR_SPEED,
    MEASURED_POSITION,
    MEASURED_TORQUE,
    MEASURED_VELOCITY,
    POWER,
    SELF_COLLISION,
    WALL,
    Violations,
)
from station.memory.doubles import Doubles, own, zeros
from station.memory.functions import square_root

# Larger than any distance of an end effector from a joint axis [m].
_REACH = 1.3


class JointWatch:
    """Finds the readings of n joints that violate a limit.

    Args:
        memory: State of the joints.
        chain: The arm's chain of n joints, see `arm_chain`.
        tool: Pose of the end effector in the flange's frame, 16 numbers; kept.
        limits: The arm's limits.
        thresholds: Thresholds that Franka does not publish.
        period: Duration of a cycle [s], > 0.
        has_hand: Whether a hand is mounted.

    Attributes:
        violations: Violations in the last cycle.
        room: Distance that a point of the arm may still move before a distance between
            links or to a wall can be too short [m].
        is_alert: Whether a reading had to be examined in the cycle before.
    """

    def __init__(
        self,
        memory: JointMemory,
        chain: Doubles,
        tool: Doubles,
        limits: ArmLimits,
        thresholds: SupervisorLimits,
        period: float,
        *,
        has_hand: bool,
    ) -> None:
        self.memory = memory
        self.size = memory.size
        self.limits = limits
        self.chain = own(chain)
        self.tool = tool
        self.links = new_links(chain)
        self.flange = self.links[16 * self.size :]
        self.pose = zeros(16)
        self.desired = zeros(16)
        self.jacobian = zeros(6 * self.size)
        self.twist = zeros(6)
        tolerance = thresholds.position_tolerance
        self.lower = own([value - tolerance for value in limits.lower])
        self.upper = own([value + tolerance for value in limits.upper])
        factor = thresholds.velocity_factor
        # Taken from the largest velocity: limits that depend on the position go to 0,
        # where a share of them would leave no room for noise.
        slack = [value * factor - value for value in limits.velocity]
        pairs = [*zip(limits.velocity, slack, strict=True)]
        self.slowest = own([-value - slack for value, slack in pairs])
        self.fastest = own([value + slack for value, slack in pairs])
        self.curves = VelocityCurves(
            limits.velocity, limits.curves, [-value for value in slack]
        )
        self.has_curves = self.curves.size > 0
        self.torque = own([value * thresholds.torque_factor for value in limits.torque])
        self.reach_in_a_cycle = _REACH * period
        self.speed = limits.translation.velocity * factor
        self.power = thresholds.power
        self.limits_power = thresholds.power < inf
        self.translation, self.rotation, self.elbow = thresholds.path_deviation
        self.distances = link_distances(has_hand=has_hand)
        self.least_distance = thresholds.self_collision_distance
        self.walls = own([*thresholds.cartesian_lower, *thresholds.cartesian_upper])
        self.room = 0.0
        self.is_alert = False
        self.violations = Violations()

    def check_readings(self, is_following: bool, has_moved: bool) -> bool:  # noqa: FBT001
        """Compare all readings with their limits.

        Args:
            is_following: Whether the arm follows the desired motion.
            has_moved: Whether a cycle has passed since the last call.

        Returns:
            Whether a limit is violated.
        """
        memory, violations = self.memory, self.violations
        q, dq, tau, q_d = memory.positions, memory.dtheta, memory.tau_J, memory.q_d
        lower, upper, largest = self.lower, self.upper, self.torque
        slowest, fastest = self.slowest, self.fastest
        total = away = 0.0
        # Distance that any point of the arm may have moved by a joint of 1 rad/s.
        reach = self.reach_in_a_cycle if has_moved else 0.0
        violations.count = 0
        if self.has_curves:  # where the joints are
            self.curves.put(memory.positions, slowest, fastest)
        for i in range(self.size):
            position, velocity, torque = q[i], dq[i], tau[i]
            # `not … <=`, so that NaN violates the limit.
            if not lower[i] <= position <= upper[i]:
                bound = min(self.limits.upper[i], upper[i])
                if position < lower[i]:
                    bound = max(self.limits.lower[i], lower[i])
                violations.add(MEASURED_POSITION, i, position, bound)
            # Without `abs`, whose call costs time in Python.
            if velocity < 0.0:
                if not slowest[i] <= velocity:
                    self.note_velocity(i)
                velocity = -velocity
            elif not velocity <= fastest[i]:
                self.note_velocity(i)
            if torque < 0.0:
                torque = -torque
            if torque > largest[i]:
                violations.add(MEASURED_TORQUE, i, tau[i], largest[i])
            total += velocity
            if is_following:
                distance = position - q_d[i]
                away += distance if distance > 0.0 else -distance
        is_fast = not total * _REACH < self.speed
        is_close = not is_following or not (
            away * _REACH > self.translation
            or away > self.rotation
            or away > self.elbow
        )
        # Distances take long to compute, so only when they may have become too short.
        # No distance shrinks faster than if all joints turned together at the longest
        # reach.
        self.room -= total * reach
        if not self.room > 0.0:
            self.check_distances()
        if is_fast or not is_close:
            self.place(q, self.pose)
        if is_fast:
            self.check_speed()
        if self.limits_power:
            self.check_power()
        if not is_close:
            self.check_deviation()
        return violations.count > 0

    def note_velocity(self, joint: int) -> None:
        """Add the violation of a joint whose velocity is beyond its limits."""
        velocity = self.memory.dtheta[joint]
        slowest, fastest = self.limits.velocity_range(
            joint, self.memory.positions[joint]
        )
        bound = fastest if velocity > 0.0 else slowest
        self.violations.add(MEASURED_VELOCITY, joint, velocity, bound)

    def check_distances(self) -> None:
        """Compare the distances of links and walls with their limits."""
        self.place(self.memory.positions, self.pose)
        distance, least = self.distances.measure(self.links), self.least_distance
        room = distance - least
        if room < 0.0:
            pair = self.distances.closest
            self.violations.add(SELF_COLLISION, pair, distance, least)
        for axis in range(3):
            value = self.pose[12 + axis]
            low, high = self.walls[axis], self.walls[axis + 3]
            if value - low < room:
                room = value - low
            if high - value < room:
                room = high - value
            if not low <= value <= high:
                bound = low if value < low else high
                self.violations.add(WALL, axis, value, bound)
        self.room = room

    def check_speed(self) -> None:
        """Compare the speed of the end effector at its placed pose with its limit."""
        zero_jacobian(self.links, self.pose, self.jacobian)
        twist_of(self.jacobian, self.memory.dtheta, self.twist)
        speed = _length(self.twist)
        if speed > self.speed:
            bound = self.limits.translation.velocity
            self.violations.add(END_EFFECTOR_SPEED, 0, speed, bound)

    def check_power(self) -> None:
        """Compare the power of all joints with its limit."""
        dq, tau = self.memory.dtheta, self.memory.tau_J
        power = 0.0
        for i in range(self.size):
            power += abs(dq[i]) * abs(tau[i])
        if power > self.power:
            self.violations.add(POWER, 0, power, self.power)

    def check_deviation(self) -> None:
        """Compare the end effector, placed by `place`, with the desired motion."""
        memory, pose, desired = self.memory, self.pose, self.desired
        self.place(memory.q_d, desired)
        way = self.twist
        for i in range(3):
            way[i] = desired[12 + i] - pose[12 + i]
        shift = _length(way)
        rotation_between(pose, desired, way)
        turn, bend = _length(way), abs(memory.positions[2] - memory.q_d[2])
        if shift > self.translation:
            self.violations.add(DEVIATION, 0, shift, self.translation)
        if turn > self.rotation:
            self.violations.add(DEVIATION, 1, turn, self.rotation)
        if bend > self.elbow:
            self.violations.add(DEVIATION, 2, bend, self.elbow)

    def place(self, q: Doubles, pose: Doubles) -> None:
        """Write the poses of the links, and the end effector's pose into `pose`."""
        place_links(self.chain, q, self.links)
        compose(self.flange, self.tool, pose)


def _length(vector: Doubles) -> float:
    x, y, z = vector[0], vector[1], vector[2]
    return square_root(x * x + y * y + z * z)
