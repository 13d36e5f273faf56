"""How an arm follows a pose or a twist: checks, joint 3, and the next positions.

Source: Franka Control Interface documentation, Cartesian motion generators; differs:
the inverse kinematics of the arm is not public; here it is a Newton step per cycle with
the position of joint 3 as the seventh coordinate.
"""

from collections.abc import Iterable

from station.core.franka.command_rates import limited
from station.core.franka.joint_memory import JointMemory
from station.core.numerics.rigid_motion import displace, twist_between
from station.hw.franka.simulated.command_check import CommandCheck
from station.hw.franka.simulated.inverse_kinematics import InverseKinematics
from station.memory.doubles import Doubles, own, zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into

UNIT_TOLERANCE = 1e-5
"""Largest deviation from 1 of the length of a row or a column of a rotation."""
TWIST_SIZE = 6
"""How many numbers of a command are a twist; any other command is a pose."""
# Below these the motion has ended: change of a joint in a cycle [rad]; velocity [m/s,
# rad/s] and acceleration [m/s^2, rad/s^2] of end effector and elbow.
_STILL_STEP = 1e-12
_STILL_VELOCITY = 1e-9
_STILL_ACCELERATION = 1e-6


def is_transform(pose: Doubles) -> bool:
    """Return whether 16 finite numbers are a homogeneous transform, column-major.

    Orthogonality and handedness are not tested.

    Source: libfranka@0.9.2 src/control_tools.cpp, isHomogeneousTransformation.
    """
    if pose[3] != 0.0 or pose[7] != 0.0 or pose[11] != 0.0 or pose[15] != 1.0:
        return False
    for i in range(3):
        x, y, z = pose[4 * i], pose[4 * i + 1], pose[4 * i + 2]
        away = square_root(x * x + y * y + z * z) - 1.0
        if not -UNIT_TOLERANCE <= away <= UNIT_TOLERANCE:
            return False
        x, y, z = pose[i], pose[i + 4], pose[i + 8]
        away = square_root(x * x + y * y + z * z) - 1.0
        if not -UNIT_TOLERANCE <= away <= UNIT_TOLERANCE:
            return False
    return True


class CartesianStep:
    """The motion of an arm's end effector, a cycle at a time.

    `follow` is the usual cycle. Whoever has to look closer at an unusual one calls the
    other methods one by one.

    Args:
        memory: State and commands of the joints.
        kinematics: Leads from `q_d` towards its target, which is the next pose.
        check: Compares commanded motions of the joints with their limits.
        pose: The commanded pose of the last cycle, 16 numbers.
        twist: Its twist [m/s, rad/s], shape (6,).
        acceleration: The rate of the twist [m/s^2, rad/s^2], shape (6,).
        elbow: Position of joint 3 [rad] in the last cycle, first of its numbers.
        elbow_velocity: Its velocity [rad/s], likewise.
        elbow_acceleration: Its acceleration [rad/s^2], likewise.
        translation: Largest velocity, acceleration and jerk of the translation.
        rotation: Largest velocity, acceleration and jerk of the rotation.
        elbow_limits: Largest velocity, acceleration and jerk of joint 3.
        period: Duration of a cycle, > 0 [s].

    Attributes:
        command: The command of this cycle, a pose or a twist, shape (16,).
        size: How many numbers the command has.
        has_elbow: Whether the command gives a position of joint 3.
        next_pose: The pose that follows, 16 numbers.
        next_twist: The twist that leads there [m/s, rad/s], shape (6,).
        next_elbow: Position, velocity and acceleration of joint 3 that follow.
        target: The joints' next positions [rad], shape (n,).
        is_settled: Whether the joints rest where the pose of the last cycle is.
    """

    def __init__(
        self,
        memory: JointMemory,
        kinematics: InverseKinematics,
        check: CommandCheck,
        *,
        pose: Doubles,
        twist: Doubles,
        acceleration: Doubles,
        elbow: Doubles,
        elbow_velocity: Doubles,
        elbow_acceleration: Doubles,
        translation: Iterable[float],
        rotation: Iterable[float],
        elbow_limits: Iterable[float],
        period: float,
    ) -> None:
        self.memory = memory
        self.target = memory.target
        self.kinematics = kinematics
        self.check = check
        self.pose = pose
        self.twist = twist
        self.acceleration = acceleration
        self.elbow = elbow
        self.elbow_velocity = elbow_velocity
        self.elbow_acceleration = elbow_acceleration
        self.translation = own(translation)
        self.rotation = own(rotation)
        self.elbow_limits = own(elbow_limits)
        self.period = period
        self.command = zeros(16)
        self.size = 0
        self.has_elbow = False
        self.next_pose = kinematics.target
        self.next_twist = zeros(6)
        self.next_elbow = zeros(3)
        self.is_settled = False

    def follow(self) -> bool:
        """Follow the command, and write the joints' next positions as their target.

        Returns:
            Whether that was done. If not, the command must be looked at, and the
            motion has not changed.
        """
        if self.has_elbow:
            return False
        if self.is_settled and self.repeats():
            copy_into(self.target, 0, self.memory.q_d, self.memory.size)
            return True
        if not self.plan() or not self.admits_twist():
            return False
        self.rest_elbow()
        self.move_joints()
        if not self.check.admit_positions():
            return False
        self.accept()
        self.is_settled = self.is_still()
        return True

    def repeats(self) -> bool:
        """Return whether the command is the pose of the last cycle."""
        if self.size == TWIST_SIZE:
            return False
        for i in range(16):
            if self.command[i] != self.pose[i]:
                return False
        return True

    def is_still(self) -> bool:
        """Return whether nothing moves after the last `accept`."""
        if not (
            -_STILL_VELOCITY < self.elbow_velocity[0] < _STILL_VELOCITY
            and -_STILL_ACCELERATION < self.elbow_acceleration[0] < _STILL_ACCELERATION
        ):
            return False
        for i in range(6):
            if not (
                -_STILL_VELOCITY < self.twist[i] < _STILL_VELOCITY
                and -_STILL_ACCELERATION < self.acceleration[i] < _STILL_ACCELERATION
            ):
                return False
        step = self.kinematics.step
        for i in range(self.memory.size):
            if not -_STILL_STEP < step[i] < _STILL_STEP:
                return False
        return True

    def plan(self) -> bool:
        """Compute the next pose and twist; return False if the pose is no transform."""
        command, pose = self.command, self.next_pose
        if self.size == TWIST_SIZE:
            self.plan_twist(command)
            return True
        if not is_transform(command):
            return False
        copy_into(pose, 0, command, 16)
        twist_between(self.pose, pose, self.period, self.next_twist)
        return True

    def plan_twist(self, twist: Doubles) -> None:
        """Compute the next pose and twist for a twist [m/s, rad/s], shape (6,)."""
        for i in range(6):
            self.next_twist[i] = twist[i]
        displace(self.pose, self.next_twist, self.period, self.next_pose)

    def admits_twist(self) -> bool:
        """Return whether the next twist is certainly within the limits."""
        return self.admits(0, self.translation) and self.admits(3, self.rotation)

    def admits(self, start: int, bounds: Doubles) -> bool:
        """Return whether three numbers of the next twist are within the limits.

        Args:
            start: Where in the twist they begin.
            bounds: Largest norms of velocity, acceleration and jerk.
        """
        new, old, last_rate = self.next_twist, self.twist, self.acceleration
        period = self.period
        speed = acceleration = jerk = 0.0
        for i in range(start, start + 3):
            velocity = new[i]
            rate = (velocity - old[i]) / period
            change = (rate - last_rate[i]) / period
            speed += velocity * velocity
            acceleration += rate * rate
            jerk += change * change
        return (
            square_root(speed) <= bounds[0]
            and square_root(acceleration) <= bounds[1]
            and square_root(jerk) <= bounds[2]
        )

    def rest_elbow(self) -> None:
        """Let joint 3 come to rest: the arm's own choice."""
        limits, following, period = self.elbow_limits, self.next_elbow, self.period
        speed = self.elbow_velocity[0]
        last = self.elbow_acceleration[0]
        rate = limited(
            0.0, speed, last, limits[1], limits[2], -limits[0], limits[0], period
        )
        following[0] = self.elbow[0] + rate * period
        following[1] = rate
        following[2] = (rate - speed) / period

    def extrapolate(self) -> None:
        """Go on with constant acceleration, because no command has arrived."""
        following, period = self.next_elbow, self.period
        for i in range(6):
            self.next_twist[i] = self.twist[i] + self.acceleration[i] * period
        displace(self.pose, self.next_twist, period, self.next_pose)
        following[2] = self.elbow_acceleration[0]
        following[1] = self.elbow_velocity[0] + following[2] * period
        following[0] = self.elbow[0] + following[1] * period

    def move_joints(self) -> None:
        """Write the joints' positions that belong to the next pose as their target."""
        memory, kinematics = self.memory, self.kinematics
        q, target, step = memory.q_d, self.target, kinematics.step
        kinematics.advance(self.next_elbow[0])
        for i in range(memory.size):
            target[i] = q[i] + step[i]

    def accept(self) -> None:
        """Make the next pose, twist and elbow the last ones."""
        self.is_settled = False
        twist, acceleration, new = self.twist, self.acceleration, self.next_twist
        following, period = self.next_elbow, self.period
        for i in range(6):
            acceleration[i] = (new[i] - twist[i]) / period
            twist[i] = new[i]
        copy_into(self.pose, 0, self.next_pose, 16)
        self.elbow[0] = following[0]
        self.elbow_velocity[0] = following[1]
        self.elbow_acceleration[0] = following[2]
