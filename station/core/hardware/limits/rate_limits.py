"""Limits of position and velocity commands against the commands of the last cycle.

These limits can be used instead of saturation and soft limits. They limit acceleration
and jerk, too. A joint outside its range is not pulled back, but may only move towards
the range. Effort commands have no rate to limit and are saturated in this mode.
Infinity stands for a limit that a joint does not have.

The limits act against the velocity and acceleration of the last cycle. They are applied
in this order, so that the later ones win:

1. jerk: the acceleration changes by at most `j_max * period`;
2. acceleration: at most `a_max`, and less near `v_max` so that the jerk limit can hold;
3. velocity: at most `v_max`;
4. range: the joint can still stop at the bound with `a_max`; outside its range it may
   only move back towards it.

`approach` gives the largest rate from which a value stops within a distance D when the
rate may fall by `r * period` in each cycle: `r * (sqrt(2*D/r) - period/2)`. One cycle
later, the rate minus `r * period` is again at most the value of `approach`. Therefore
range and acceleration never contradict each other, nor do velocity and jerk. If both
acceleration and jerk are limited, braking begins earlier, by the distance that the rise
of the deceleration takes. The range then seldom requires more jerk than allowed; if it
does, the range wins.
"""

from collections.abc import Mapping
from functools import partial

from station.core.hardware.limits import limited_joints as codes
from station.core.hardware.limits.limited_joints import LimitedJoints
from station.memory.doubles import Storage
from station.memory.functions import square_root

# As C numbers, by the .pxd; the bit with all 64 that a mask has.
_BIT = 1
_POSITION = codes.POSITION
_VELOCITY = codes.VELOCITY
_ACCELERATION = codes.ACCELERATION
_JERK = codes.JERK
_INFINITY = float("inf")
_NO_REASON = -1


def approach(distance: float, rate_limit: float, period: float) -> float:
    """Return the largest rate from which a value can stop within a distance.

    Args:
        distance: Distance to the bound, in the unit of the value; <= 0 beyond it.
        rate_limit: Fastest fall of the rate, >= 0; inf if it may fall at once.
        period: Time between two changes of the rate [s], > 0.

    Returns:
        The rate, >= 0, in the unit of the value per second.
    """
    if distance <= 0.0:
        return 0.0
    one_cycle = distance / period
    if rate_limit == _INFINITY or distance == _INFINITY:
        return one_cycle
    if rate_limit <= 0.0:
        return 0.0
    if rate_limit * period < one_cycle:
        one_cycle = rate_limit * period
    rate = rate_limit * (square_root(2.0 * distance / rate_limit) - period / 2.0)
    if rate > one_cycle:
        return rate
    return one_cycle


def stoppable(
    distance: float,
    velocity: float,
    acceleration: float,
    max_acceleration: float,
    max_jerk: float,
    period: float,
) -> float:
    """Return the velocity from which a joint can stop when jerk is limited, too.

    Args:
        distance: Distance to the bound [rad or m].
        velocity: Velocity of the last cycle, towards the bound [rad/s or m/s].
        acceleration: Acceleration of the last cycle, towards the bound [rad/s^2 or
            m/s^2].
        max_acceleration: Acceleration limit, finite, >= 0 [rad/s^2 or m/s^2].
        max_jerk: Jerk limit, finite, >= 0 [rad/s^3 or m/s^3].
        period: Time since the last cycle [s], > 0.

    Returns:
        The velocity, >= 0; 0 if a limit is 0.
    """
    if max_acceleration <= 0.0 or max_jerk <= 0.0:
        return 0.0
    # First the acceleration must fall to 0, which adds a^2/(2 j) of speed and takes
    # the distance v a/j + a^3/(3 j^2). The stop takes v^2/(2 a) + v a/(2 j).
    speed = 0.0
    if acceleration > 0.0:
        fall = acceleration / max_jerk
        speed = acceleration * fall / 2.0
        if velocity < 0.0:
            velocity = 0.0
        distance = distance - (velocity + acceleration * fall / 3.0) * fall
    if distance < 0.0:
        distance = 0.0
    onset = max_acceleration / (2.0 * max_jerk) + period
    root = square_root(onset * onset + 2.0 * distance / max_acceleration)
    highest = max_acceleration * (root - onset) - speed
    if highest < 0.0:
        return 0.0
    return highest


class VelocityRateLimits(LimitedJoints):
    """Velocity commands that keep to range, velocity, acceleration and jerk.

    `velocity_before` is NaN before the first cycle. `reason` is negative for a joint
    whose last command was not changed.

    Args:
        views: See `LimitedJoints`.
        has_positions: Whether the commands are positions, whose velocities are limited.
    """

    def __init__(
        self,
        views: Mapping[str, Storage],
        has_positions: bool = False,  # noqa: FBT001, FBT002 - for the compiler
    ) -> None:
        super().__init__(views)
        self.has_positions = has_positions

    def shape(
        self, i: int, asked: float, down: float, up: float, period: float
    ) -> float:
        """Return the admissible velocity nearest to the requested one, and store it.

        Args:
            i: Index of the joint; its `reason` becomes the code of the limit, or
                negative.
            asked: Requested velocity [rad/s or m/s].
            down: Distance to the lower bound [rad or m]; negative beyond it, inf if
                there is none.
            up: Distance to the upper bound [rad or m]; negative beyond it, inf if there
                is none.
            period: Time since the last cycle [s], > 0.
        """
        reason = _NO_REASON
        before = self.velocity_before[i]
        rate_before = self.acceleration_before[i]
        max_velocity = self.max_velocity[i]
        max_acceleration = self.max_acceleration[i]
        max_jerk = self.max_jerk[i]
        given = asked
        # An upper bound is never negative and a lower one never positive, so only the
        # bound on the side of the velocity's sign can act.
        if max_jerk < _INFINITY and max_acceleration < _INFINITY:
            if given > 0.0:
                bound = stoppable(
                    up, before, rate_before, max_acceleration, max_jerk, period
                )
                if bound < given:
                    given = bound
                    reason = _POSITION
            else:
                bound = -stoppable(
                    down, -before, -rate_before, max_acceleration, max_jerk, period
                )
                if given < bound:
                    given = bound
                    reason = _POSITION
        if max_jerk < _INFINITY or max_acceleration < _INFINITY:
            wanted = (given - before) / period
            rate = wanted
            bound = rate_before - max_jerk * period
            if rate < bound:
                rate = bound
                reason = _JERK
            bound = rate_before + max_jerk * period
            if bound < rate:
                rate = bound
                reason = _JERK
            if rate > 0.0:
                bound = approach(max_velocity - before, max_jerk, period)
                if not bound < max_acceleration:
                    bound = max_acceleration
                if bound < rate:
                    rate = bound
                    reason = _ACCELERATION
            else:
                bound = approach(max_velocity + before, max_jerk, period)
                if not bound < max_acceleration:
                    bound = max_acceleration
                if rate < -bound:
                    rate = -bound
                    reason = _ACCELERATION
            if rate < wanted or wanted < rate:
                given = before + rate * period
        if given < -max_velocity:
            given = -max_velocity
            reason = _VELOCITY
        elif max_velocity < given:
            given = max_velocity
            reason = _VELOCITY
        if given > 0.0:
            bound = approach(up, max_acceleration, period)
            if bound < given:
                given = bound
                reason = _POSITION
        else:
            bound = -approach(down, max_acceleration, period)
            if given < bound:
                given = bound
                reason = _POSITION
        self.acceleration_before[i] = (given - before) / period
        self.velocity_before[i] = given
        self.reason[i] = reason
        return given

    def enforce(self, period: float, first: int, last: int) -> int:
        """See `LimitedJoints.enforce`."""
        mask = 0
        command, previous, reason = self.command, self.previous, self.reason
        before, min_position = self.velocity_before, self.min_position
        max_position = self.max_position
        has_positions = self.has_positions
        # The distance to a bound counts from the last command, or from the position.
        starts = previous if has_positions else self.position
        for i in range(first, last):
            asked = command[i]
            # The manager refuses NaN; after it the profile starts anew.
            if asked != asked:
                before[i] = asked
                continue
            if before[i] != before[i]:
                previous[i] = self.position[i]
                before[i] = self.velocity[i]
                self.acceleration_before[i] = 0.0
            start = starts[i]
            if period <= 0.0:
                command[i] = start if has_positions else before[i]
                continue
            down = start - min_position[i]
            up = max_position[i] - start
            velocity = (asked - start) / period if has_positions else asked
            given = self.shape(i, velocity, down, up, period)
            if has_positions:
                velocity, given = given, asked
                if reason[i] >= 0.0:
                    given = start + velocity * period
                    # A correction of rounding.
                    if down >= 0.0 and given < min_position[i]:
                        given = min_position[i]
                    if up >= 0.0 and given > max_position[i]:
                        given = max_position[i]
                previous[i] = given
            if reason[i] >= 0.0:
                command[i] = given
                self.asked[i] = asked
                mask |= _BIT << (i - first)
        return mask


PositionRateLimits = partial(VelocityRateLimits, has_positions=True)
"""Position commands whose velocity keeps to the limits of `VelocityRateLimits`."""
