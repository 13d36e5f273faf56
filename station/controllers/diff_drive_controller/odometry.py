"""Follow where a base with two sides of wheels is.

Source: ros_controllers@678b92a, ros2_controllers@6.x
diff_drive_controller/src/odometry.cpp.
"""

from collections import deque
from math import cos, pi, sin

_STRAIGHT, _EXACTLY_STRAIGHT = 10e-3, 1e-6
"""Turn in one cycle below which the second-order integration is used [rad]."""
_SHORTEST = 1e-4
"""Shortest time over which a velocity is estimated [s]."""


class Odometry:
    """Position, heading and velocity of a base. Control thread only.

    Args:
        separation: Distance between the two sides [m], > 0.
        radii: Radius of the left and of the right wheels [m], > 0.
        window: Number of estimates over which velocities are averaged, > 0.
        is_ros2: Whether the heading is that of ROS 2, without a bound; otherwise it
            is kept from -pi to pi.

    Attributes:
        x: Position in the frame `odom` [m].
        y: Position [m].
        heading: Angle about z [rad].
        linear: Velocity forwards [m/s].
        angular: Velocity about z [rad/s].

    Source:
        ros_controllers@678b92a diff_drive_controller/src/odometry.cpp, Odometry;
        differs: the wheels' positions at the start count as the place where the base
        is, so that a start does not move it.
    """

    def __init__(
        self,
        separation: float,
        radii: tuple[float, float],
        window: int,
        *,
        is_ros2: bool = False,
    ) -> None:
        self.x = self.y = self.heading = 0.0
        self.linear = self.angular = 0.0
        self._separation = separation
        self._radii = radii
        self._is_ros2 = is_ros2
        self._left = self._right = 0.0
        self._time = 0.0
        self._linear: deque[float] = deque(maxlen=window)
        self._angular: deque[float] = deque(maxlen=window)

    def forget_velocity(self, left: float, right: float, time: float) -> None:
        """Forget the velocity; position and heading stay.

        Args:
            left: Mean position of the left wheels [rad].
            right: Mean position of the right wheels [rad].
            time: Station time [s].
        """
        self._left, self._right = left * self._radii[0], right * self._radii[1]
        self._time = time
        self._linear.clear()
        self._angular.clear()
        self.linear = self.angular = 0.0

    def follow_wheels(self, left: float, right: float, time: float) -> None:
        """Advance the pose by the angles by which the wheels have turned.

        Args:
            left: Mean position of the left wheels [rad].
            right: Mean position of the right wheels [rad].
            time: Station time [s].
        """
        left_way = left * self._radii[0] - self._left
        right_way = right * self._radii[1] - self._right
        self._left += left_way
        self._right += right_way
        self._follow(left_way, right_way, time)

    def follow_velocities(self, left: float, right: float, time: float) -> None:
        """Advance the pose by the velocities of the wheels since the last call.

        Args:
            left: Mean velocity of the left wheels [rad/s].
            right: Mean velocity of the right wheels [rad/s].
            time: Station time [s].
        """
        elapsed = time - self._time
        self._follow(
            left * self._radii[0] * elapsed, right * self._radii[1] * elapsed, time
        )

    def _follow(self, left_way: float, right_way: float, time: float) -> None:
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
        """Advance the pose by the velocities commanded since the last call.

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
        if abs(angular) < (_EXACTLY_STRAIGHT if self._is_ros2 else _STRAIGHT):
            direction = before + angular / 2.0
            self.x += linear * cos(direction)
            self.y += linear * sin(direction)
            self.heading = before + angular
            if not self._is_ros2:
                self.heading = (self.heading + pi) % (2.0 * pi) - pi
            return
        self.heading = before + angular
        self.x += linear / angular * (sin(self.heading) - sin(before))
        self.y -= linear / angular * (cos(self.heading) - cos(before))
