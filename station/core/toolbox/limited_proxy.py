"""Track a set-point with limited velocity and effort, and return without overshoot.

The joint follows a proxy. The proxy follows the set-point like a body with limited
acceleration, and the joint drags it along when the effort limit is reached. Therefore
no error winds up, and the joint returns smoothly when an obstacle has gone.

| step            | formula                                                           |
|-----------------|-------------------------------------------------------------------|
| proxy           | trapezoidal integration of `acc = acc_des + a(p, v)` with         |
|                 | p, v relative to the set-point                                    |
| near, far       | `a = -2*l*v - l^2*p` for `l^2*abs(p) <= 3*c`, else                |
|                 | `a = -2*l*v - sign(p)*(sqrt(8*c*(l^2*abs(p) - c)) - c)`           |
| velocity limit  | `acc` between `-l*(v - v_max)` and `-l*(v + v_max)`, implicitly   |
| effort          | `m*acc - kd*e_v - kp*e_p - clip(ki*e_i, +-i_clamp)`, clipped      |

with l = bandwidth, c = acceleration, e = measured value minus proxy.

Source: control_toolbox@de05a5c src/limited_proxy.cpp, LimitedProxy; differs: negative
parameters are refused, while the original's integer `abs` makes them positive whole
numbers; its unused position limits are left out.
"""

from dataclasses import dataclass, fields
from math import isfinite, sqrt

from station.core.errors import InvalidGainError


@dataclass(frozen=True, slots=True)
class LimitedProxyGains:
    """The parameters of a limited proxy, all >= 0.

    Attributes:
        mass: Estimate of the joint's inertia [kg*m^2 or kg].
        kd: Damping gain [N*m*s/rad or N*s/m].
        kp: Position gain [N*m/rad or N/m].
        ki: Integral gain [N*m/(rad*s) or N/(m*s)].
        i_clamp: Largest integral part of the effort [N*m or N].
        effort_limit: Largest effort [N*m or N]; 0 for no limit.
        velocity_limit: Largest velocity of the proxy [rad/s or m/s]; 0 for no limit.
        bandwidth: Rate at which the proxy converges [1/s]; 0 puts the proxy onto the
            set-point.
        acceleration: Acceleration for convergence [rad/s^2 or m/s^2], > 0 unless
            `bandwidth` is 0.

    Raises:
        InvalidGainError: A value is negative or not finite, or the acceleration is 0.
    """

    mass: float = 0.0
    kd: float = 0.0
    kp: float = 0.0
    ki: float = 0.0
    i_clamp: float = 0.0
    effort_limit: float = 0.0
    velocity_limit: float = 0.0
    bandwidth: float = 0.0
    acceleration: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (isfinite(value) and value >= 0.0):
                raise InvalidGainError(
                    f"Limited proxy's {field.name} is {value}; allowed are finite "
                    "numbers >= 0.",
                    remedy=f"Correct {field.name}.",
                )
        if self.bandwidth > 0.0 and self.acceleration == 0.0:
            raise InvalidGainError(
                f"Limited proxy has a bandwidth of {self.bandwidth} 1/s, and an "
                "acceleration of 0 to converge with.",
                remedy="Give an acceleration > 0, or a bandwidth of 0.",
            )


class LimitedProxy:
    """Compute efforts from a set-point and the measured state, once per cycle.

    Attributes:
        gains: The parameters; may be replaced by another thread at any time.
    """

    def __init__(self, gains: LimitedProxyGains) -> None:
        """Start at position 0; call `reset` before the first update.

        Args:
            gains: The parameters.
        """
        self.gains: LimitedProxyGains = gains
        self._position: float = 0.0
        self._velocity: float = 0.0
        self._acceleration: float = 0.0
        self._position_error: float = 0.0
        self._integral_error: float = 0.0

    def reset(self, position: float, velocity: float) -> None:
        """Put the proxy onto the joint.

        Args:
            position: Measured position [rad or m].
            velocity: Measured velocity [rad/s or m/s].
        """
        self._position = position
        self._velocity = velocity
        self._acceleration = 0.0
        self._position_error = 0.0
        self._integral_error = 0.0

    def update(
        self,
        desired: tuple[float, float, float],
        position: float,
        velocity: float,
        period: float,
    ) -> float:
        """Return the effort for this cycle.

        Args:
            desired: Position [rad or m], velocity [rad/s or m/s] and acceleration
                [rad/s^2 or m/s^2] of the set-point.
            position: Measured position [rad or m].
            velocity: Measured velocity [rad/s or m/s].
            period: Time since the last cycle [s], >= 0.

        Returns:
            The effort [N*m or N].
        """
        gains = self.gains
        self._move_proxy(gains, desired, period)
        velocity_error = velocity - self._velocity
        last_error = self._position_error
        self._position_error = position - self._position
        self._integral_error += period / 2.0 * (last_error + self._position_error)
        linear = (
            gains.mass * self._acceleration
            - gains.kd * velocity_error
            - gains.kp * self._position_error
        )
        integral = gains.ki * self._integral_error
        effort = linear - _clip(integral, gains.i_clamp)
        if gains.effort_limit > 0.0:
            effort = _clip(effort, gains.effort_limit)
            self._drag_proxy(gains, effort - linear, -integral, period)
        if abs(gains.ki * self._integral_error) > gains.i_clamp:
            bound = gains.i_clamp / gains.ki
            self._integral_error = _clip(self._integral_error, bound)
        return effort

    def _move_proxy(
        self,
        gains: LimitedProxyGains,
        desired: tuple[float, float, float],
        period: float,
    ) -> None:
        if gains.bandwidth == 0.0:
            self._position, self._velocity, self._acceleration = desired
            return
        bandwidth = gains.bandwidth
        if bandwidth * period > 2.0:
            bandwidth = 2.0 / period  # a larger one makes the integration unstable
        half = period / 2.0
        free_velocity = self._velocity + half * self._acceleration
        free_position = self._position + half * (self._velocity + free_velocity)
        pull, slope = _converge(
            free_position - desired[0],
            free_velocity - desired[1],
            bandwidth,
            gains.acceleration,
        )
        damping = 1.0 + 2.0 * bandwidth * period / 2.0
        stiffness = slope * (period * period) / 4.0
        acceleration = (desired[2] + pull) / (damping - stiffness)
        if gains.velocity_limit > 0.0:
            inertia = 1.0 + bandwidth * period / 2.0
            high = -bandwidth * (free_velocity - gains.velocity_limit) / inertia
            low = -bandwidth * (free_velocity + gains.velocity_limit) / inertia
            acceleration = min(max(acceleration, low), high)
        last_velocity = self._velocity
        self._velocity += half * (self._acceleration + acceleration)
        self._position += half * (last_velocity + self._velocity)
        self._acceleration = acceleration

    def _drag_proxy(
        self, gains: LimitedProxyGains, missing: float, integral: float, period: float
    ) -> None:
        # Shift the proxy's highest derivative that costs effort, and the lower ones
        # with it, so that the next effort equals the clipped one.
        half = period / 2.0
        shares = (1.0, half, half * half, half * half * half)
        if gains.mass == 0.0:
            shares = (0.0, 1.0, half, half * half)
            if gains.kd == 0.0:
                shares = (0.0, 0.0, 1.0, half)
                if gains.kp == 0.0:
                    return
        cost = gains.mass * shares[0] + gains.kd * shares[1] + gains.kp * shares[2]
        shift = (missing - integral) / (cost + gains.ki * shares[3])
        shifted = integral + shift * gains.ki * shares[3]
        if abs(shifted) > gains.i_clamp:
            shift = (missing - _clip(shifted, gains.i_clamp)) / cost
        self._acceleration += shift * shares[0]
        self._velocity += shift * shares[1]
        self._position += shift * shares[2]
        self._position_error -= shift * shares[2]
        self._integral_error -= shift * shares[3]


def _clip(value: float, bound: float) -> float:
    return min(max(value, -bound), bound)


def _converge(
    position: float, velocity: float, bandwidth: float, acceleration: float
) -> tuple[float, float]:
    # Acceleration towards 0, and its derivative with respect to the position.
    square = bandwidth * bandwidth
    damping = -2.0 * bandwidth * velocity
    way = square * abs(position)
    if way <= 3.0 * acceleration:
        return damping - square * position, -square
    pull = sqrt(8.0 * acceleration * (way - acceleration)) - acceleration
    slope = -square * sqrt(2.0 * acceleration / (way - acceleration))
    return (damping - pull if position > 0.0 else damping + pull), slope
