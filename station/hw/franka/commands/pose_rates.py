"""Low-pass filter and rate limits of Cartesian commands, as libfranka has them.

Source: libfranka@0.9.2 src/lowpass_filter.cpp, cartesianLowpassFilter;
src/rate_limiting.cpp, limitRate; src/control_loop.cpp, convertMotion.
"""

from collections.abc import Iterable

from station.core.numerics.rigid_motion import displace, rotation_between, twist_between
from station.memory.doubles import Doubles, own, zeros
from station.memory.functions import square_root

# A shorter vector has no direction.
_TINY = 1e-15


def limit_vector(
    vector: Doubles,
    start: int,
    last_velocity: Doubles,
    last_acceleration: Doubles,
    bounds: Doubles,
    share: float,
    period: float,
) -> None:
    """Replace a velocity by the nearest one that all limits allow.

    Close to the velocity limit the acceleration is limited further, so that it can
    reach zero at the limit without exceeding the jerk limit.

    Args:
        vector: Holds the new velocity [m/s or rad/s] in three numbers.
        start: Where in all vectors the three numbers begin.
        last_velocity: The last command.
        last_acceleration: Its acceleration [m/s^2 or rad/s^2].
        bounds: Largest norms of velocity, acceleration and jerk, each > 0.
        share: Share of the bounds that is allowed, > 0.
        period: Duration of a cycle, > 0 [s].

    Source:
        libfranka@0.9.2 src/rate_limiting.cpp, limitRate of a vector.
    """
    fastest, rate, jerk = share * bounds[0], share * bounds[1], share * bounds[2]
    i, j, k = start, start + 1, start + 2
    v0, v1, v2 = last_velocity[i], last_velocity[j], last_velocity[k]
    a0, a1, a2 = last_acceleration[i], last_acceleration[j], last_acceleration[k]
    x = ((vector[i] - v0) / period - a0) / period
    y = ((vector[j] - v1) / period - a1) / period
    z = ((vector[k] - v2) / period - a2) / period
    size = square_root(x * x + y * y + z * z)
    scale = 0.0
    if size > _TINY:
        scale = (jerk if jerk < size else size) / size
    x, y, z = (
        a0 + scale * x * period,
        a1 + scale * y * period,
        a2 + scale * z * period,
    )
    size = square_root(x * x + y * y + z * z)
    step = 0.0
    if size > _TINY:
        x, y, z = x / size, y / size, z / size
        along = x * v0 + y * v1 + z * v2
        room = along * along - (v0 * v0 + v1 * v1 + v2 * v2) + fastest * fastest
        safe = jerk / rate * (square_root(room if room > 0.0 else 0.0) - along)
        if rate < safe:
            safe = rate
        if not safe > 0.0:
            safe = 0.0
        step = (safe if safe < size else size) * period
    elif size <= _TINY:
        x, y, z = 0.0, 0.0, 0.0
    vector[i] = v0 + x * step
    vector[j] = v1 + y * step
    vector[k] = v2 + z * step


class PoseRates:
    """Filters and limits the poses or the twists that are sent to an arm.

    Args:
        pose: The last commanded pose, which the arm reports, 16 numbers.
        twist: The last commanded twist [m/s, rad/s], shape (6,).
        acceleration: Its rate [m/s^2, rad/s^2], shape (6,).
        translation: Largest velocity, acceleration and jerk of the translation.
        rotation: Largest velocity, acceleration and jerk of the rotation.
        pose_share: Share of the limits of the rotation that a pose may use.
        period: Duration of a cycle, > 0 [s].

    Attributes:
        gain: Share of a new command in the low-pass; 1 is off.
        is_limiting: Whether the rates are limited.
        sent_pose: The pose to send, 16 numbers.
        sent_twist: The twist to send, shape (6,).
    """

    def __init__(
        self,
        pose: Doubles,
        twist: Doubles,
        acceleration: Doubles,
        *,
        translation: Iterable[float],
        rotation: Iterable[float],
        pose_share: float,
        period: float,
    ) -> None:
        self.pose = pose
        self.twist = twist
        self.acceleration = acceleration
        self.translation = own(translation)
        self.rotation = own(rotation)
        self.pose_share = pose_share
        self.period = period
        self.gain = 1.0
        self.is_limiting = False
        self.sent_pose = zeros(16)
        self.sent_twist = zeros(6)
        self.way = zeros(6)

    def filter_pose(self, pose: Doubles, passes: bool) -> None:  # noqa: FBT001 - C
        """Compute the pose to send.

        Args:
            pose: The commanded pose, 16 numbers.
            passes: Whether the low-pass lets this command pass unchanged.
        """
        last, way, sent, gain = self.pose, self.way, self.sent_pose, self.gain
        if gain < 1.0 and not passes:
            rotation_between(last, pose, way)
            for i in range(3):
                way[3 + i] = gain * way[i]
                way[i] = gain * (pose[12 + i] - last[12 + i])
            displace(last, way, 1.0, sent)
        else:
            for i in range(16):
                sent[i] = pose[i]
        if self.is_limiting:
            twist_between(last, sent, self.period, way)
            self.limit(way, self.pose_share)
            displace(last, way, self.period, sent)

    def filter_twist(self, twist: Doubles) -> None:
        """Compute the twist to send.

        Args:
            twist: The commanded twist [m/s, rad/s], shape (6,).
        """
        last, sent, gain = self.twist, self.sent_twist, self.gain
        for i in range(6):
            value = twist[i]
            if gain < 1.0:
                value = gain * value + (1.0 - gain) * last[i]
            sent[i] = value
        if self.is_limiting:
            self.limit(sent, 1.0)

    def limit(self, twist: Doubles, rotation_share: float) -> None:
        """Replace a twist by the nearest one that all limits allow.

        Args:
            twist: The twist [m/s, rad/s], shape (6,).
            rotation_share: Share of the limits of the rotation that is allowed.
        """
        v, a, period = self.twist, self.acceleration, self.period
        limit_vector(twist, 0, v, a, self.translation, 1.0, period)
        limit_vector(twist, 3, v, a, self.rotation, rotation_share, period)
