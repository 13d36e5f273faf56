"""The joint motion that belongs to a motion of the end effector at one configuration.

The arm has seven joints or more, of which joint 3, the elbow, is moved by itself. The
others follow the end effector by a damped inverse of the Jacobian.
"""

from collections.abc import Iterable

from station.controllers.cartesian_motion.cartesian_motion_generator import PoseMotion
from station.core.numerics.arm_chain import WrenchEquation
from station.core.numerics.rigid_motion import twist_between
from station.memory.doubles import Doubles, Storage, own, zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into

# Small enough for full accuracy; keeps the matrix invertible at a singular pose.
_DAMPING = 1e-9
# More than rounding can change singular values.
_ROUNDING = 1.001


class LinearKinematics:
    """The linearised kinematics of an arm at joint positions.

    Args:
        q: Joint positions [rad], shape (n,); kept and not copied.
        jacobian: Jacobian of the end effector in the axes of the base, 6 n numbers,
            column-major; kept, and read by `invert` and `is_dexterous`.
        velocity: Largest joint velocities [rad/s], shape (n,); kept.
        acceleration: Largest joint accelerations [rad/s^2], shape (n,); kept.

    Attributes:
        velocity: As given.
        acceleration: As given.
    """

    def __init__(
        self, q: Doubles, jacobian: Doubles, velocity: Storage, acceleration: Storage
    ) -> None:
        self.size = len(q)
        self.velocity, self.acceleration = velocity, acceleration
        self.q = q
        self.jacobian = jacobian
        self.dq = own([0.0] * self.size)
        self.motion = own([0.0] * 6)
        # Transposed, 6 numbers per joint; those of joint 3 are zero.
        self.inverse = own([0.0] * (6 * self.size))
        self.others = own([0.0] * (6 * self.size))
        # A copy of the Jacobian for `drift` and `joint_step`. How much each joint turns
        # at most for a motion of length 1, and how far away its axis is [m].
        self.columns = own([0.0] * (6 * self.size))
        self.lengths = own([0.0] * self.size)
        self.arms = own([0.0] * self.size)
        self.equation = WrenchEquation()

    def invert(self) -> None:
        """Bring the inverse up to date with the Jacobian."""
        inverse, columns = self.inverse, self.columns
        copy_into(columns, 0, self.jacobian, 6 * self.size)
        self.put_others(inverse)
        # Without a Jacobian of finite numbers there is no motion.
        is_known = self.equation.factorise(inverse, _DAMPING)
        for joint in range(self.size):
            column = inverse[6 * joint : 6 * joint + 6]
            self.equation.solve(column, column)
            # Interpreted, a part of a list is a copy.
            copy_into(inverse, 6 * joint, column, 6)
        if not is_known:
            for k in range(len(inverse)):
                inverse[k] = 0.0
        for joint in range(self.size):
            k = 6 * joint
            x, y, z = columns[k], columns[k + 1], columns[k + 2]
            self.arms[joint] = _ROUNDING * square_root(x * x + y * y + z * z)
            square = 0.0
            for k in range(6 * joint, 6 * joint + 6):
                square += inverse[k] * inverse[k]
            self.lengths[joint] = _ROUNDING * square_root(square)

    def put_others(self, columns: Doubles) -> None:
        """Write the Jacobian with zeros for joint 3.

        Args:
            columns: Receives the result, 6 numbers per joint.
        """
        copy_into(columns, 0, self.jacobian, 6 * self.size)
        for k in range(12, 18):
            columns[k] = 0.0

    def is_dexterous(self, least: float) -> bool:
        """Return True only if the extended Jacobian is far from a singular one.

        The extended Jacobian A has the row of joint 3 below the Jacobian, so that A dq
        is the twist and the velocity of joint 3. With the column c of joint 3 and the
        other columns J, all singular values of A are above s < 1 if, and only if,
        J J^T - s^2 - c c^T s^2 / (1 - s^2) is positive definite. That holds if
        J J^T - s^2 - |c|^2 s^2 / (1 - s^2) is positive definite, which is tested here.

        Args:
            least: Bound of the singular values, >= 0.

        Returns:
            True if all singular values are above the bound; False if that is unknown.
        """
        jacobian = self.jacobian
        square = 0.0
        for k in range(12, 18):
            square += jacobian[k] * jacobian[k]
        share = (_ROUNDING * least) * (_ROUNDING * least)
        if not share < 1.0:
            return False
        share += square * (share / (1.0 - share))
        self.put_others(self.others)
        return self.equation.factorise(self.others, -share)

    def joint_step(self, way: Doubles, elbow: float, step: Doubles) -> None:
        """Write the joint motion that displaces the end effector by a small way.

        Args:
            way: Translation [m], then rotation vector [rad], in the axes of the base,
                shape (6,).
            elbow: Desired position of joint 3 [rad].
            step: Receives the changes of the joint positions [rad], shape (n,).
        """
        jacobian, motion = self.columns, self.motion
        bend = elbow - self.q[2]
        for row in range(6):
            motion[row] = way[row] - bend * jacobian[12 + row]
        self.write_joint_rates(motion, step)
        step[2] = bend

    def write_joint_rates(self, motion: Doubles, result: Doubles) -> None:
        """Write joint rates for rates of the end effector, joint 3 at rest.

        Args:
            motion: A twist [m/s, rad/s], or another quantity linear in it, shape (6,).
            result: Receives the rates of the joints, shape (n,).
        """
        inverse = self.inverse
        a, b, c = motion[0], motion[1], motion[2]
        d, e, f = motion[3], motion[4], motion[5]
        for joint in range(self.size):
            k = 6 * joint
            result[joint] = (
                inverse[k] * a
                + inverse[k + 1] * b
                + inverse[k + 2] * c
                + inverse[k + 3] * d
                + inverse[k + 4] * e
                + inverse[k + 5] * f
            )

    def drift(self, dq: Doubles, result: Doubles) -> None:
        """Write the acceleration of the end effector while no joint accelerates.

        Args:
            dq: Joint velocities [rad/s], shape (n,).
            result: Receives the acceleration [m/s^2, rad/s^2], shape (6,).
        """
        jacobian = self.columns
        wx, wy, wz, ax, ay, az = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        bx, by, bz = 0.0, 0.0, 0.0
        for joint in range(self.size):
            k, rate = 6 * joint, dq[joint]
            vx = rate * jacobian[k]
            vy = rate * jacobian[k + 1]
            vz = rate * jacobian[k + 2]
            zx = rate * jacobian[k + 3]
            zy = rate * jacobian[k + 4]
            zz = rate * jacobian[k + 5]
            # The joint turns with the joints before it.
            bx = bx + wy * zz - wz * zy
            by = by + wz * zx - wx * zz
            bz = bz + wx * zy - wy * zx
            # Velocities of the links before and behind it, added up.
            ux, uy, uz = wx, wy, wz
            wx, wy, wz = wx + zx, wy + zy, wz + zz
            ux, uy, uz = ux + wx, uy + wy, uz + wz
            ax = ax + uy * vz - uz * vy
            ay = ay + uz * vx - ux * vz
            az = az + ux * vy - uy * vx
        result[0], result[1], result[2] = ax, ay, az
        result[3], result[4], result[5] = bx, by, bz

    def are_slow(self, twist: Doubles, push: float) -> bool:
        """Return True only if no joint exceeds its bounds; False if that is unknown.

        The test assumes the worst case: the end effector accelerates in the direction
        that moves a joint most, and it drifts as if all axes were parallel.

        Args:
            twist: Twist of the end effector [m/s, rad/s], shape (6,).
            push: Length of its largest acceleration [m/s^2, rad/s^2].
        """
        dq, arms, velocity = self.dq, self.arms, self.velocity
        self.write_joint_rates(twist, dq)
        turn = linear = angular = 0.0
        for joint in range(self.size):
            rate = dq[joint]
            if rate < 0.0:
                rate = -rate
            if not rate <= velocity[joint]:
                return False
            linear += (turn + turn + rate) * rate * arms[joint]
            angular += turn * rate
            turn += rate
        drift = square_root(linear * linear + angular * angular)
        if self.are_pushed_little(push + drift):
            return True
        self.drift(dq, self.motion)
        return self.are_pushed_little(push + length_of(self.motion))

    def are_pushed_little(self, push: float) -> bool:
        """Return whether an acceleration of this size is allowed in any direction."""
        lengths, acceleration = self.lengths, self.acceleration
        for joint in range(self.size):
            if not lengths[joint] * push <= acceleration[joint]:
                return False
        return True

    def fastest_joint(self, twist: Doubles, accelerations: Doubles) -> int:
        """Return the index of the joint that exceeds its bounds most; -1 if none does.

        Args:
            twist: Twist of the end effector [m/s, rad/s], shape (6,).
            accelerations: Two accelerations of the end effector [m/s^2, rad/s^2], shape
                (12,); zero acceleration is checked as well.
        """
        dq, motion, inverse = self.dq, self.motion, self.inverse
        velocity, acceleration = self.velocity, self.acceleration
        self.write_joint_rates(twist, dq)
        self.drift(dq, motion)
        a0, a1, a2 = -motion[0], -motion[1], -motion[2]
        a3, a4, a5 = -motion[3], -motion[4], -motion[5]
        b0, b1, b2 = accelerations[0], accelerations[1], accelerations[2]
        b3, b4, b5 = accelerations[3], accelerations[4], accelerations[5]
        c0, c1, c2 = accelerations[6], accelerations[7], accelerations[8]
        c3, c4, c5 = accelerations[9], accelerations[10], accelerations[11]
        worst, found = 1.0, -1
        for joint in range(self.size):
            k = 6 * joint
            p, q, r = inverse[k], inverse[k + 1], inverse[k + 2]
            s, t, u = inverse[k + 3], inverse[k + 4], inverse[k + 5]
            rest = p * a0 + q * a1 + r * a2 + s * a3 + t * a4 + u * a5
            first = rest + (p * b0 + q * b1 + r * b2 + s * b3 + t * b4 + u * b5)
            second = rest + (p * c0 + q * c1 + r * c2 + s * c3 + t * c4 + u * c5)
            bound = worst * velocity[joint]
            if not -bound <= dq[joint] <= bound:
                worst, found = abs(dq[joint]) / velocity[joint], joint
            bound = worst * acceleration[joint]
            if not -bound <= rest <= bound:
                worst, found = abs(rest) / acceleration[joint], joint
                bound = worst * acceleration[joint]
            if not -bound <= first <= bound:
                worst, found = abs(first) / acceleration[joint], joint
                bound = worst * acceleration[joint]
            if not -bound <= second <= bound:
                worst, found = abs(second) / acceleration[joint], joint
        return found


def length_of(vector: Storage) -> float:
    """Return the length of a vector, shape (6,)."""
    a, b, c, d, e, f = vector[0], vector[1], vector[2], vector[3], vector[4], vector[5]
    return square_root(a * a + b * b + c * c + d * d + e * e + f * f)


def way_between(first: Doubles, second: Doubles) -> float:
    """Return the sum of the distances between joint positions [rad].

    Args:
        first: Joint positions [rad], shape (n,).
        second: Other positions [rad], shape (n,).
    """
    total = 0.0
    for joint in range(len(first)):
        away = first[joint] - second[joint]
        total += away if away > 0.0 else -away
    return total


# Results for one configuration are used for configurations within this distance [rad].
_NEAR = 0.01


class StopPrediction:
    """The rest positions of n joints after each step, and their distance to limits.

    The positions at which the joints would rest after a step follow from the pose at
    which the end effector would rest, by the linearised kinematics of a configuration
    nearby.

    Args:
        pose: Pose of the end effector at the configuration `resting`, 16 numbers; kept
            and not copied.
        new: Joint positions at rest after the new step [rad], shape (n,); kept and not
            copied.
        lower: Smallest joint positions [rad], shape (n,).
        upper: Largest joint positions [rad], shape (n,).

    Attributes:
        present: Kinematics at a configuration near the desired joint positions.
        resting: Kinematics at a configuration near the positions at rest.
    """

    def __init__(
        self,
        pose: Doubles,
        new: Doubles,
        *,
        lower: Iterable[float],
        upper: Iterable[float],
    ) -> None:
        size = len(new)
        self.pose = pose
        self.new = new
        self.lower, self.upper = own(lower), own(upper)
        self.q_d = zeros(size)
        self.elbow = 0.0
        unknown = zeros(size)
        self.present = LinearKinematics(unknown, zeros(6 * size), unknown, unknown)
        self.resting = self.present
        # Positions at rest after the last allowed step, and those at which the arm was
        # clear, with the way that it may go from there.
        self.room = 0.0
        self.rest, self.clear = own([0.0] * size), own([0.0] * size)
        self.way, self.step = own([0.0] * 6), own([0.0] * size)
        self.size = size

    def start_at_rest(self, q_d: Doubles) -> None:
        """Start at rest.

        Args:
            q_d: Desired joint positions [rad], shape (n,), which are kept.
        """
        self.q_d = q_d
        self.elbow = q_d[2]
        copy_into(self.new, 0, q_d, self.size)
        self.accept()

    def passes(self, motion: PoseMotion) -> bool:
        """Return whether a step is certainly allowed; if so, accept it.

        Such a step is within all limits, near the configurations that are known. Any
        other step has to be examined.

        Args:
            motion: The motion of the end effector after the step.
        """
        if (
            motion.is_at_rest()
            or self.has_left()
            or self.leads_away(motion)
            or self.limited_joint() >= 0
            or self.may_collide()
            or not self.are_slow(motion)
            or not motion.stays_within_speed()
        ):
            return False
        self.accept()
        return True

    def has_left(self) -> bool:
        """Return whether the arm is no longer near the configuration `present`."""
        return way_between(self.q_d, self.present.q) > _NEAR

    def leads_away(self, motion: PoseMotion) -> bool:
        """Compute the positions at rest; return whether they are not near `resting`.

        Args:
            motion: The motion of the end effector after a step.
        """
        resting = self.resting
        motion.brake()
        twist_between(self.pose, motion.resting, 1.0, self.way)
        resting.joint_step(self.way, self.elbow, self.step)
        largest = 0.0
        for joint in range(self.size):
            away = self.step[joint]
            self.new[joint] = resting.q[joint] + away
            away = away if away > 0.0 else -away
            if not away <= largest:
                largest = away
        return largest > _NEAR

    def limited_joint(self) -> int:
        """Return the index of the first joint that would go beyond a limit, or -1.

        A joint that is beyond a limit may come back.
        """
        for joint in range(self.size):
            low, new, high = self.lower[joint], self.new[joint], self.upper[joint]
            if not low <= new <= high:
                old = self.rest[joint]
                if (new < old and new < low) or (new > old and new > high):
                    return joint
        return -1

    def may_collide(self) -> bool:
        """Return whether the clearance at the positions at rest is unknown."""
        return way_between(self.new, self.clear) > self.room

    def are_slow(self, motion: PoseMotion) -> bool:
        """Return whether no joint exceeds its bounds, now and where the arm would rest.

        Args:
            motion: The motion of the end effector after a step.
        """
        present, resting = self.present, self.resting
        push = length_of(motion.acceleration)
        braking = length_of(motion.peaks)
        if push < braking:
            push = braking
        return (
            present.are_slow(motion.twist, push)
            or present.fastest_joint(motion.twist, motion.accelerations) < 0
        ) and (
            resting.are_slow(motion.twist, push)
            or resting.fastest_joint(motion.twist, motion.accelerations) < 0
        )

    def accept(self) -> None:
        """Take the step: the joints can rest at the new positions."""
        copy_into(self.rest, 0, self.new, self.size)

    def note_clearance(self, room: float) -> None:
        """Note that no parts of the arm are near each other at the new positions.

        Args:
            room: Sum of joint motions from there up to which this holds [rad]; at least
                `_NEAR` counts.
        """
        self.room = room if room > _NEAR else _NEAR
        copy_into(self.clear, 0, self.new, self.size)
