"""Generate poses that follow targets within limits of velocity, acceleration and jerk.

The motion has six coordinates: the position, and the rotation vector from the present
orientation in the axes of the base. The rotation vector starts at zero again in every
cycle. Its rates therefore equal the angular velocity and acceleration, the limits hold
for rotations of any size, and the rotation to a target is always the shorter one.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from station.controllers.cartesian_motion.pose_motion import PoseMotion
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.memory.doubles import Doubles, put, zeros

if TYPE_CHECKING:
    from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits

_SLACK = 1.0 + 1e-9  # for rounding


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
        self._generator.start(self.motion.coordinates(), [0.0] * 6)
        self._take_rates()

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
        """Return whether the pose is at rest, and so is its target."""
        return self._generator.is_still and self._wanted is None

    def brake(self) -> None:
        """Come to rest as soon as the limits allow."""
        if not self.is_still():
            self.go_at([0.0] * 6)

    def is_at_rest(self) -> bool:
        """Return whether all velocities and accelerations are zero."""
        return self._generator.is_still or self.motion.is_at_rest()

    def resting_pose(self) -> Doubles:
        """Return the pose at which the motion rests if it brakes now, 16 numbers."""
        self.motion.brake()
        return memoryview(self.motion.resting)

    def stays_within_speed(self) -> bool:
        """Return whether no velocity exceeds its limit while the motion brakes."""
        return self.motion.stays_within_speed()

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

    def _take_rates(self) -> None:
        _, velocities, accelerations = self._generator.state()
        self.motion.take_rates(velocities, accelerations)
