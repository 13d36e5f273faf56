"""Generate poses that follow targets within limits of velocity, acceleration and jerk.

The motion has six coordinates: the position, and the rotation vector from the present
orientation in the axes of the base. The rotation vector starts at zero again in every
cycle. Its rates therefore equal the angular velocity and acceleration, the limits hold
for rotations of any size, and the rotation to a target is always the shorter one.
"""

from collections.abc import Sequence

from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.kernel.braking import braking_peaks, peak_speed, resting_ways
from station.kernel.doubles import Doubles, doubles, put, zeros
from station.kernel.rigid_motion import displace, rotation_between

# Velocities and accelerations below this are rounding after a motion has ended.
_AT_REST = 1e-12
_SLACK = 1.0 + 1e-9  # for rounding


class CartesianMotionGenerator:
    """The smooth motion of a pose. Control thread only.

    The lengths of the vectors of velocity, acceleration and jerk stay within the
    limits, for the translation and for the rotation.

    Args:
        limits: The limits.

    Attributes:
        pose: Desired pose, 16 numbers, column-major; always the same memory.
        twist: Desired linear [m/s] and angular velocity [rad/s] in the axes of the
            base, shape (6,).
        accelerations: Desired linear [m/s^2] and angular [rad/s^2] acceleration in the
            same axes, then the peak acceleration of each axis while the motion brakes,
            shape (12,).
    """

    def __init__(self, limits: CartesianLimits) -> None:
        self._limits = limits
        axes = limits.of_axes()
        self._generator = MotionGenerator(axes)
        self._largest, self._jerk = doubles(axes.acceleration), doubles(axes.jerk)
        self.pose, self._resting, self._target = zeros(16), zeros(16), zeros(16)
        self._last = (self._generator.state(), [0.0] * 16)
        self._way = zeros(6)
        self._has_target = False
        self.twist, self.accelerations = zeros(6), zeros(12)
        self._acceleration = self.accelerations[:6]
        self._braking = self.accelerations[6:]

    def start(self, pose: Sequence[float]) -> None:
        """Start at rest at a pose.

        Args:
            pose: The pose, 16 numbers, column-major.
        """
        put(self.pose, pose)
        self._has_target = False
        self._generator.start(self._coordinates(), [0.0] * 6)
        self._take_rates()

    def go_to(self, pose: Sequence[float]) -> None:
        """Make a pose the target: position and orientation arrive together and rest.

        Args:
            pose: Target pose, 16 numbers, column-major.
        """
        put(self._target, pose)
        self._has_target = True

    def go_at(self, twist: list[float]) -> None:
        """Make a twist the target.

        Args:
            twist: Velocity [m/s], then angular velocity [rad/s], in the axes of the
                base, each with a length within its limit.
        """
        self._has_target = False
        self._generator.go_at(twist)

    @property
    def is_still(self) -> bool:
        """Whether the pose rests, and nothing but rest is wanted."""
        return self._generator.is_still and not self._has_target

    def brake(self) -> None:
        """Come to rest as soon as the limits allow."""
        if not self.is_still:
            self.go_at([0.0] * 6)

    def is_at_rest(self) -> bool:
        """Return whether all velocities and accelerations are zero."""
        now = self._generator
        if now.is_still:
            return True
        return max(map(abs, (*now.velocities, *self._acceleration))) < _AT_REST

    def resting_pose(self) -> Doubles:
        """Return the pose at which the motion rests if it brakes now, 16 numbers."""
        way = self._way
        resting_ways(self.twist, self._acceleration, self._largest, self._jerk, way)
        displace(self.pose, way, 1.0, self._resting)
        return self._resting

    def stays_within_speed(self) -> bool:
        """Return whether no velocity exceeds its limit while the motion brakes."""
        v, a, jerk, limits = self.twist, self._acceleration, self._jerk, self._limits
        return (
            peak_speed(v[:3], a[:3], jerk[:3]) <= limits.translation.velocity * _SLACK
            and peak_speed(v[3:], a[3:], jerk[3:]) <= limits.rotation.velocity * _SLACK
        )

    def advance(self, period: float) -> None:
        """Advance the motion by one period.

        Args:
            period: Time since the last cycle [s], >= 0; nothing happens when it is 0.

        Raises:
            InvalidCommandError: There is no motion to the target.
        """
        if period == 0.0 or self.is_still:
            return
        generator, pose, way = self._generator, self.pose, self._way
        self._last = (generator.state(), [*pose])
        if self._has_target:
            rotation_between(pose, self._target, way)
            generator.go_to([*self._target[12:15], *way[:3]])
        generator.advance(period)
        x, y, z, *turn = generator.positions
        put(way, (x - pose[12], y - pose[13], z - pose[14], *turn))
        displace(pose, way, 1.0, pose)
        generator.relocate(self._coordinates())
        self._take_rates()

    def undo(self) -> None:
        """Return to the state before the last `advance`; the target stays."""
        state, pose = self._last
        put(self.pose, pose)
        self._generator.restore(state)
        self._take_rates()

    def _coordinates(self) -> list[float]:
        return [*self.pose[12:15], 0.0, 0.0, 0.0]

    def _take_rates(self) -> None:
        generator, v, a = self._generator, self.twist, self._acceleration
        put(v, generator.velocities)
        put(a, generator.accelerations)
        braking_peaks(v, a, self._largest, self._jerk, self._braking)
