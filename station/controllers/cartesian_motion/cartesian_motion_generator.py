"""Generate poses that follow targets within limits of velocity, acceleration and jerk.

The motion has six coordinates: the position, and the rotation vector from the present
orientation in the axes of the base. The rotation vector starts at zero again in every
cycle. Its rates therefore equal the angular velocity and acceleration, the limits hold
for rotations of any size, and the rotation to a target is always the shorter one.
"""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.core.numerics.rigid_motion import displace, rotation_between
from station.memory.doubles import Doubles, own, put, zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into

if TYPE_CHECKING:
    from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits

_SLACK = 1.0 + 1e-9  # for rounding
# Velocities and accelerations below this are rounding after a motion has ended.
_AT_REST = 1e-12
_POSE = 16
_AXES = 6


def peak_speed(velocities: Doubles, accelerations: Doubles, jerks: Doubles) -> float:
    """Return the length of the vector of the peak speeds of axes that brake.

    Args:
        velocities: Present velocities, shape (n,).
        accelerations: Present accelerations, shape (n,).
        jerks: Largest jerks, > 0, shape (n,).
    """
    total = 0.0
    for axis in range(len(velocities)):
        v, a = velocities[axis], accelerations[axis]
        peak = v + (a if a > 0.0 else -a) * a / (2.0 * jerks[axis])
        v, peak = v * v, peak * peak
        total += peak if peak > v else v
    return square_root(total)


class PoseMotion:
    """A pose with its twist and acceleration; arrays are kept and not copied.

    Args:
        pose: The pose, 16 numbers, column-major.
        target: The pose to go to, 16 numbers.
        twist: Linear [m/s] and angular velocity [rad/s], in the axes of the base, shape
            (6,).
        accelerations: Linear [m/s^2] and angular [rad/s^2] acceleration in the same
            axes, then the peak acceleration of each axis while it brakes, shape (12,).
        largest: Largest acceleration of each axis, > 0, shape (6,); copied.
        jerk: Largest jerk of each axis, > 0, shape (6,); copied.
        speeds: Largest length of the velocity [m/s] and of the angular velocity
            [rad/s], > 0, shape (2,).

    Attributes:
        resting: The pose that `brake` has computed, 16 numbers; not written otherwise.
    """

    def __init__(
        self,
        pose: Doubles,
        target: Doubles,
        twist: Doubles,
        accelerations: Doubles,
        *,
        largest: Iterable[float],
        jerk: Iterable[float],
        speeds: tuple[float, float],
    ) -> None:
        self.pose = pose
        self.target = target
        self.twist = twist
        self.velocity, self.turn = twist[:3], twist[3:]
        self.accelerations = accelerations
        self.acceleration = accelerations[:6]
        self.forward, self.spin = accelerations[:3], accelerations[3:6]
        self.peaks = accelerations[6:]
        self.largest, self.jerk = own(largest), own(jerk)
        self.forward_jerk, self.spin_jerk = self.jerk[:3], self.jerk[3:]
        self.fastest, self.fastest_turn = speeds
        self.resting, self.last = zeros(_POSE), zeros(_POSE)
        self.way = own([0.0] * _AXES)
        # The result of `aim`, in memory and as the list.
        self.there, self.aimed_at = own([0.0] * _AXES), [0.0] * _AXES

    def aim(self) -> list[float]:
        """Return the coordinates of the target, seen from the pose, shape (6,).

        The list is the same one as long as the coordinates stay the same.
        """
        target, way, there = self.target, self.way, self.there
        rotation_between(self.pose, target, way)
        x, y, z = target[12], target[13], target[14]
        if (
            there[0] == x
            and there[1] == y
            and there[2] == z
            and there[3] == way[0]
            and there[4] == way[1]
            and there[5] == way[2]
        ):
            return self.aimed_at
        there[0], there[1], there[2] = x, y, z
        there[3], there[4], there[5] = way[0], way[1], way[2]
        self.aimed_at = [x, y, z, way[0], way[1], way[2]]
        return self.aimed_at

    def coordinates(self) -> list[float]:
        """Return the present coordinates, shape (6,): the rotation vector is zero."""
        pose = self.pose
        return [pose[12], pose[13], pose[14], 0.0, 0.0, 0.0]

    def move(
        self,
        positions: list[float],
        velocities: list[float],
        accelerations: list[float],
    ) -> list[float]:
        """Move the pose to the positions of the axes; return the new coordinates.

        These are `positions` themselves if nothing turns and nothing was rounded.

        Args:
            positions: Positions of the axes, from the pose before, shape (6,).
            velocities: Their velocities, shape (6,).
            accelerations: Their accelerations, shape (6,).
        """
        pose, way = self.pose, self.way
        copy_into(self.last, 0, pose, _POSE)
        way[0], way[1], way[2], way[3], way[4], way[5] = positions
        x, y, z = way[0], way[1], way[2]
        way[0], way[1], way[2] = x - pose[12], y - pose[13], z - pose[14]
        displace(pose, way, 1.0, pose)
        self.take_rates(velocities, accelerations)
        turns = way[3] != 0.0 or way[4] != 0.0 or way[5] != 0.0
        if turns or pose[12] != x or pose[13] != y or pose[14] != z:
            return self.coordinates()
        return positions

    def undo(self, velocities: list[float], accelerations: list[float]) -> None:
        """Restore the pose before `move`.

        Args:
            velocities: Velocities of the axes before `move`, shape (6,).
            accelerations: Their accelerations, shape (6,).
        """
        copy_into(self.pose, 0, self.last, _POSE)
        self.take_rates(velocities, accelerations)

    def take_rates(self, velocities: list[float], accelerations: list[float]) -> None:
        """Take new rates of the axes; compute the peaks while they brake.

        An axis with velocity v and acceleration a that brakes with jerk j reaches
        sqrt(|v| j + a^2 / 2), unless its acceleration limit is smaller.

        Args:
            velocities: Velocities of the axes, shape (6,).
            accelerations: Their accelerations, shape (6,).
        """
        v, a = self.twist, self.acceleration
        v[0], v[1], v[2], v[3], v[4], v[5] = velocities
        a[0], a[1], a[2], a[3], a[4], a[5] = accelerations
        for axis in range(_AXES):
            speed, change = v[axis], a[axis]
            peak = (speed if speed > 0.0 else -speed) * self.jerk[axis]
            peak += change * change / 2.0
            peak = square_root(peak) if peak > 0.0 else 0.0
            if peak > self.largest[axis]:
                peak = self.largest[axis]
            self.peaks[axis] = peak if speed < 0.0 else -peak

    def is_at_rest(self) -> bool:
        """Return whether no axis moves or accelerates, but for rounding."""
        v, a = self.twist, self.acceleration
        for axis in range(_AXES):
            if not (-_AT_REST < v[axis] < _AT_REST and -_AT_REST < a[axis] < _AT_REST):
                return False
        return True

    def brake(self) -> None:
        """Compute the pose at which the motion rests if it brakes now."""
        way, largest = self.way, self.largest
        for axis in range(_AXES):
            v, a, j = self.twist[axis], self.acceleration[axis], self.jerk[axis]
            if v == 0.0 and a == 0.0:
                way[axis] = 0.0
                continue
            # The velocity when the acceleration has become zero tells which way it
            # brakes.
            sign = 1.0
            if v + (a if a > 0.0 else -a) * a / (2.0 * j) < 0.0:
                sign, v, a = -1.0, -v, -a
            peak = v * j + a * a / 2.0
            peak = square_root(peak) if peak > 0.0 else 0.0
            hold = 0.0
            if peak > largest[axis]:
                peak = largest[axis]
                hold = (v + (a * a / 2.0 - peak * peak) / j) / peak
            # Jerk to the peak, constant acceleration, jerk back to zero.
            t = (a + peak) / j
            stop = t * (v + t * (a / 2.0 - t * j / 6.0))
            v = v + t * (a - t * j / 2.0)
            stop += hold * (v - hold * peak / 2.0)
            v -= hold * peak
            t = peak / j
            stop += t * (v - t * (peak / 2.0 - t * j / 6.0))
            way[axis] = sign * stop
        displace(self.pose, way, 1.0, self.resting)

    def stays_within_speed(self) -> bool:
        """Return whether no velocity exceeds its limit while the motion brakes."""
        return (
            peak_speed(self.velocity, self.forward, self.forward_jerk) <= self.fastest
            and peak_speed(self.turn, self.spin, self.spin_jerk) <= self.fastest_turn
        )


class CartesianMotionGenerator:
    """The smooth motion of a pose. Control thread only.

    The lengths of the vectors of velocity, acceleration and jerk stay within the
    limits, for the translation and for the rotation.

    Args:
        limits: The limits.

    Attributes:
        motion: The pose with its rates, in the memory of the other attributes.
        pose: Desired pose, 16 numbers, column-major; always the same memory.
        twist: Desired linear [m/s] and angular velocity [rad/s] in the axes of the
            base, shape (6,).
        accelerations: Desired linear [m/s^2] and angular [rad/s^2] acceleration in the
            same axes, then the peak acceleration of each axis while the motion brakes,
            shape (12,).
    """

    def __init__(self, limits: "CartesianLimits") -> None:
        axes = limits.of_axes()
        self._generator = MotionGenerator(axes)
        self.pose, self._target = zeros(16), zeros(16)
        self.twist, self.accelerations = zeros(6), zeros(12)
        self.motion = PoseMotion(
            self.pose,
            self._target,
            self.twist,
            self.accelerations,
            largest=axes.acceleration,
            jerk=axes.jerk,
            speeds=(
                limits.translation.velocity * _SLACK,
                limits.rotation.velocity * _SLACK,
            ),
        )
        self._last = self._generator.state()
        # The pose that was made the target last; None when something else is.
        self._wanted: Sequence[float] | None = None

    def start(self, pose: Sequence[float]) -> None:
        """Start at rest at a pose.

        Args:
            pose: The pose, 16 numbers, column-major.
        """
        put(self.pose, pose)
        self._wanted = None
        generator = self._generator
        generator.start(self.motion.coordinates(), [0.0] * 6)
        self.motion.take_rates(generator.velocities, generator.accelerations)

    def go_to(self, pose: Sequence[float]) -> None:
        """Make a pose the target: position and orientation arrive together and rest.

        Args:
            pose: Target pose, 16 numbers, column-major; the caller does not change it
                afterwards.
        """
        if pose is not self._wanted:
            put(self._target, pose)
            self._wanted = pose

    def go_at(self, twist: list[float]) -> None:
        """Make a twist the target.

        Args:
            twist: Velocity [m/s], then angular velocity [rad/s], in the axes of the
                base, each with a length within its limit.
        """
        self._wanted = None
        self._generator.go_at(twist)

    def is_still(self) -> bool:
        """Return whether pose and target are at rest."""
        return self._generator.is_still and self._wanted is None

    def brake(self) -> None:
        """Come to rest as soon as the limits allow."""
        if not self.is_still():
            self.go_at([0.0] * 6)

    def resting_pose(self) -> Doubles:
        """Return the pose at which the motion rests if it brakes now, 16 numbers."""
        self.motion.brake()
        return memoryview(self.motion.resting)

    def advance(self, period: float) -> None:
        """Advance the motion by one period.

        Args:
            period: Time since the last cycle [s], >= 0; nothing happens when it is 0.

        Raises:
            InvalidCommandError: There is no motion to the target.
        """
        if period == 0.0 or self.is_still():
            return
        generator, motion = self._generator, self.motion
        self._last = generator.state()
        if self._wanted is not None:
            generator.go_to(motion.aim())
        generator.advance(period)
        generator.relocate(
            motion.move(
                generator.positions, generator.velocities, generator.accelerations
            )
        )

    def undo(self) -> None:
        """Return to the state before the last `advance`; the target stays."""
        self._generator.restore(self._last)
        _, velocities, accelerations = self._last
        self.motion.undo(velocities, accelerations)
