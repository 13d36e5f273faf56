"""Odometry of a base with two sides of wheels, from its wheels or its commands.

Source: ros_controllers@678b92a diff_drive_controller/src/odometry.cpp, Odometry;
differs: the wheels' positions at the start count as the place where the base is, so
that a start does not move it.
"""

from collections import deque
from math import cos, pi, sin

_STRAIGHT = 10e-3
"""Turn in one cycle below which the second-order integration is used [rad]."""
_SHORTEST = 1e-4
"""Shortest time over which a velocity is estimated [s]."""


class Odometry:
    """Position, heading and velocity of a base. Control thread only.

    Args:
        separation: Distance between the two sides [m], > 0.
        radius: Radius of the wheels [m], > 0.
        window: Number of estimates over which velocities are averaged, > 0.

    Attributes:
        x: Position in the frame `odom` [m].
        y: Position [m].
        heading: Angle about z [rad].
        linear: Velocity forwards [m/s].
        angular: Velocity about z [rad/s].
    """

    def __init__(self, separation: float, radius: float, window: int) -> None:
        self.x = self.y = self.heading = 0.0
        self.linear = self.angular = 0.0
        self._separation = separation
        self._radius = radius
        self._left = self._right = 0.0
        self._time = 0.0
        self._linear: deque[float] = deque(maxlen=window)
        self._angular: deque[float] = deque(maxlen=window)

    def begin(self, left: float, right: float, time: float) -> None:
        """Forget the velocity; position and heading stay.

        Args:
            left: Mean position of the left wheels [rad].
            right: Mean position of the right wheels [rad].
            time: Station time [s].
        """
        self._left, self._right = left * self._radius, right * self._radius
        self._time = time
        self._linear.clear()
        self._angular.clear()
        self.linear = self.angular = 0.0

    def follow_wheels(self, left: float, right: float, time: float) -> None:
        """Take in how far the wheels have turned.

        Args:
            left: Mean position of the left wheels [rad].
            right: Mean position of the right wheels [rad].
            time: Station time [s].
        """
        left_way = left * self._radius - self._left
        right_way = right * self._radius - self._right
        self._left += left_way
        self._right += right_way
        linear = (left_way + right_way) / 2.0
        angular = (right_way - left_way) / self._separation
        self._integrate(linear, angular)
        elapsed = time - self._time
        if elapsed < _SHORTEST:
            return
        self._time = time
        self._linear.append(linear / elapsed)
        self._angular.append(angular / elapsed)
        self.linear = sum(self._linear) / len(self._linear)
        self.angular = sum(self._angular) / len(self._angular)

    def follow_commands(self, linear: float, angular: float, time: float) -> None:
        """Take in that the base has moved as commanded since the last call.

        Args:
            linear: Velocity forwards [m/s].
            angular: Velocity about z [rad/s].
            time: Station time [s].
        """
        self.linear, self.angular = linear, angular
        elapsed = time - self._time
        self._time = time
        self._integrate(linear * elapsed, angular * elapsed)

    def _integrate(self, linear: float, angular: float) -> None:
        before = self.heading
        if abs(angular) < _STRAIGHT:
            direction = before + angular / 2.0
            self.x += linear * cos(direction)
            self.y += linear * sin(direction)
            self.heading = (before + angular + pi) % (2.0 * pi) - pi
            return
        self.heading = before + angular
        self.x += linear / angular * (sin(self.heading) - sin(before))
        self.y -= linear / angular * (cos(self.heading) - cos(before))
