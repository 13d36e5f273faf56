"""Shape a velocity so that jerk, acceleration, velocity and range limits hold.

The limits act against the velocity and acceleration of the last cycle. They are applied
in this order, so that the later ones win:

1. jerk: the acceleration changes by at most `j_max * period`;
2. acceleration: at most `a_max`, and less towards `v_max` so that jerk can hold there;
3. velocity: at most `v_max`;
4. range: the joint can still stop at the bound with `a_max`; outside its range it may
   only move back towards it.

`approach` gives the largest rate from which a value stops within a distance D when the
rate may fall by `r * period` in each cycle: `r * (sqrt(2*D/r) - period/2)`. One cycle
later, the rate minus `r * period` is again within the value of `approach`. Therefore
range and acceleration never contradict each other, nor do velocity and jerk. With both
acceleration and jerk limits, braking begins earlier, by the distance that the rise of
the deceleration takes. The range then seldom requires more jerk than allowed; if it
does, the range wins.
"""

from math import inf, sqrt

from station.core.hardware.limits.joint_limits import JointLimits
from station.core.hardware.limits.joint_limits_handle import ClampReason
from station.core.hardware.limits.saturate import saturate


def approach(distance: float, rate_limit: float, period: float) -> float:
    """Return the largest rate from which a value can stop within a distance.

    Args:
        distance: Distance to the bound, in the unit of the value; <= 0 beyond it.
        rate_limit: Fastest fall of the rate, > 0; inf if it may fall at once.
        period: Time between two changes of the rate [s], > 0.

    Returns:
        The rate, >= 0, in the unit of the value per second.
    """
    if distance <= 0.0:
        return 0.0
    if rate_limit == inf or distance == inf:
        return distance / period
    one_cycle = min(distance / period, rate_limit * period)
    return max(one_cycle, rate_limit * (sqrt(2.0 * distance / rate_limit) - period / 2))


class VelocityProfile:
    """Limit velocities of one joint from cycle to cycle.

    Attributes:
        velocity: Velocity of the last cycle [rad/s or m/s].
        acceleration: Acceleration of the last cycle [rad/s^2 or m/s^2].
        reason: The limit that changed the last velocity, or None.
    """

    def __init__(self, limits: JointLimits) -> None:
        """Read the limits once.

        Args:
            limits: Velocity, acceleration and jerk limits, each of them optional.
        """
        self._max_velocity: float = _or_inf(limits.max_velocity)
        self._max_acceleration: float = _or_inf(limits.max_acceleration)
        self._max_jerk: float = _or_inf(limits.max_jerk)
        self.velocity: float = 0.0
        self.acceleration: float = 0.0
        self.reason: ClampReason | None = None

    def start(self, velocity: float) -> None:
        """Begin at a velocity, without acceleration.

        Args:
            velocity: Velocity before the next cycle [rad/s or m/s].
        """
        self.velocity = velocity
        self.acceleration = 0.0

    def limit(self, asked: float, down: float, up: float, period: float) -> float:
        """Return the admissible velocity nearest to the one asked for.

        Args:
            asked: Velocity [rad/s or m/s].
            down: Distance to the lower bound [rad or m]; negative beyond it, inf if
                there is none.
            up: Distance to the upper bound [rad or m]; negative beyond it, inf if there
                is none.
            period: Time since the last cycle [s], > 0.

        Returns:
            The velocity of this cycle, kept in `velocity`.
        """
        self.reason = None
        velocity = asked
        if self._max_jerk < inf and self._max_acceleration < inf:
            velocity = self._brake_early(velocity, down, up, period)
        if self._max_jerk < inf or self._max_acceleration < inf:
            velocity = self._limit_acceleration(velocity, period)
        bound = self._max_velocity
        velocity = self._apply(velocity, -bound, bound, ClampReason.VELOCITY)
        low = -approach(down, self._max_acceleration, period)
        high = approach(up, self._max_acceleration, period)
        velocity = self._apply(velocity, low, high, ClampReason.POSITION)
        self.acceleration = (velocity - self.velocity) / period
        self.velocity = velocity
        return velocity

    def _apply(
        self, value: float, low: float, high: float, reason: ClampReason
    ) -> float:
        given = saturate(value, low, high)
        if given < value or value < given:
            self.reason = reason
        return given

    def _brake_early(
        self, velocity: float, down: float, up: float, period: float
    ) -> float:
        low = -self._stoppable(down, -self.velocity, -self.acceleration, period)
        high = self._stoppable(up, self.velocity, self.acceleration, period)
        return self._apply(velocity, low, high, ClampReason.POSITION)

    def _stoppable(
        self, distance: float, velocity: float, acceleration: float, period: float
    ) -> float:
        # First the acceleration must fall to 0, which adds a^2/(2 j) of speed and takes
        # the distance v a/j + a^3/(3 j^2). The stop takes v^2/(2 a) + v a/(2 j).
        rate = self._max_acceleration
        jerk = self._max_jerk
        speed = 0.0
        if acceleration > 0.0:
            fall = acceleration / jerk
            speed = acceleration * fall / 2.0
            distance -= (max(velocity, 0.0) + acceleration * fall / 3.0) * fall
        onset = rate / (2.0 * jerk) + period
        root = sqrt(onset * onset + 2.0 * max(distance, 0.0) / rate)
        return max(rate * (root - onset) - speed, 0.0)

    def _limit_acceleration(self, velocity: float, period: float) -> float:
        asked = (velocity - self.velocity) / period
        jerk = self._max_jerk
        low = self.acceleration - jerk * period
        high = self.acceleration + jerk * period
        given = self._apply(asked, low, high, ClampReason.JERK)
        bound = self._max_acceleration
        low = -min(bound, approach(self._max_velocity + self.velocity, jerk, period))
        high = min(bound, approach(self._max_velocity - self.velocity, jerk, period))
        given = self._apply(given, low, high, ClampReason.ACCELERATION)
        if given < asked or asked < given:
            return self.velocity + given * period
        return velocity


def _or_inf(limit: float | None) -> float:
    return inf if limit is None else limit
