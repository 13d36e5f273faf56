"""Generate poses that follow targets within limits of velocity, acceleration and jerk.

The motion has six coordinates: the position, and the rotation vector from the present
orientation in the axes of the base. The rotation vector starts at zero again in every
cycle. Its rates therefore equal the angular velocity and acceleration, the limits hold
for rotations of any size, and the rotation to a target is always the shorter one.
"""

from math import copysign, sqrt

from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.core.numerics.rigid_motion import displace, rotation_between

# Velocities and accelerations below this are rounding after a motion has ended.
_AT_REST = 1e-12


class CartesianMotionGenerator:
    """The smooth motion of a pose. Control thread only.

    The lengths of the vectors of velocity, acceleration and jerk stay within the
    limits, for the translation and for the rotation.

    Args:
        limits: The limits.

    Attributes:
        pose: Desired pose, 16 numbers, column-major, a new list each cycle.
    """

    def __init__(self, limits: CartesianLimits) -> None:
        self._limits = limits
        self._axes = limits.of_axes()
        self._generator = MotionGenerator(self._axes)
        self._target: list[float] = []
        self._last = (self._generator.state(), [0.0] * 16)
        self.pose = [0.0] * 16

    @property
    def twist(self) -> list[float]:
        """Desired linear [m/s] and angular velocity [rad/s], axes of the base."""
        return self._generator.velocities

    @property
    def acceleration(self) -> list[float]:
        """Desired linear [m/s^2] and angular [rad/s^2] acceleration, same axes."""
        return self._generator.accelerations

    def braking(self) -> list[float]:
        """Return each axis' peak acceleration while the motion brakes, shape (6,).

        In m/s^2 and rad/s^2, in the axes of the base. An axis with velocity v and
        acceleration a that brakes with jerk j reaches sqrt(|v| j + a^2 / 2), unless its
        acceleration limit is smaller.
        """
        return [
            -copysign(min(largest, sqrt(abs(v) * jerk + a * a / 2.0)), v)
            for v, a, largest, jerk in zip(
                self._generator.velocities,
                self._generator.accelerations,
                self._axes.acceleration,
                self._axes.jerk,
                strict=True,
            )
        ]

    def start(self, pose: list[float]) -> None:
        """Start at rest at a pose.

        Args:
            pose: The pose, 16 numbers, column-major.
        """
        self.pose = list(pose)
        self._target = []
        self._generator.start(_coordinates(pose), [0.0] * 6)

    def go_to(self, pose: list[float]) -> None:
        """Make a pose the target: position and orientation arrive together and rest.

        Args:
            pose: Target pose, 16 numbers, column-major.
        """
        self._target = pose

    def go_at(self, twist: list[float]) -> None:
        """Make a twist the target.

        Args:
            twist: Velocity [m/s], then angular velocity [rad/s], in the axes of the
                base, each with a length within its limit.
        """
        self._target = []
        self._generator.go_at(twist)

    def brake(self) -> None:
        """Come to rest as soon as the limits allow."""
        self.go_at([0.0] * 6)

    def is_at_rest(self) -> bool:
        """Return whether all velocities and accelerations are zero."""
        now = self._generator
        return max(map(abs, (*now.velocities, *now.accelerations))) < _AT_REST

    def resting_pose(self) -> list[float]:
        """Return the pose at which the motion rests if it brakes now, 16 numbers.

        Raises:
            InvalidCommandError: There is no such motion.
        """
        end = self._generator.resting_positions()
        shift = [end[i] - self.pose[12 + i] for i in range(3)]
        return displace(self.pose, shift, end[3:])

    def stays_within_speed(self) -> bool:
        """Return whether no velocity exceeds its limit while the motion brakes."""
        peaks = [
            max(abs(v), abs(v + a * abs(a) / (2.0 * jerk)))
            for v, a, jerk in zip(
                self._generator.velocities,
                self._generator.accelerations,
                self._axes.jerk,
                strict=True,
            )
        ]
        slack = 1.0 + 1e-9
        return (
            _length(peaks[:3]) <= self._limits.translation.velocity * slack
            and _length(peaks[3:]) <= self._limits.rotation.velocity * slack
        )

    def advance(self, period: float) -> None:
        """Advance the motion by one period.

        Args:
            period: Time since the last cycle [s], >= 0; nothing happens when it is 0.

        Raises:
            InvalidCommandError: There is no motion to the target.
        """
        if period == 0.0:
            return
        generator = self._generator
        self._last = (generator.state(), self.pose)
        if self._target:
            away = rotation_between(self.pose, self._target)
            generator.go_to([*self._target[12:15], *away])
        generator.advance(period)
        reached = generator.positions
        shift = [reached[i] - self.pose[12 + i] for i in range(3)]
        self.pose = displace(self.pose, shift, reached[3:])
        generator.relocate(_coordinates(self.pose))

    def undo(self) -> None:
        """Return to the state before the last `advance`; the target stays."""
        state, self.pose = self._last
        self._generator.restore(state)


def _coordinates(pose: list[float]) -> list[float]:
    return [*pose[12:15], 0.0, 0.0, 0.0]


def _length(vector: list[float]) -> float:
    return sqrt(sum(value * value for value in vector))
