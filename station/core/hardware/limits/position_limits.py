"""Saturation and soft limits of the position commands of n joints.

See `station.core.hardware.limits.limited_joints`, whose rules hold here as well.
"""

from station.core.hardware.limits import clamp_codes as codes
from station.core.hardware.limits.limited_joints import LimitedJoints, SoftLimitedJoints

# As C numbers, by the .pxd; the bit with all 64 that a mask has.
_BIT = 1
_POSITION = codes.POSITION
_VELOCITY = codes.VELOCITY
_SOFT_POSITION = codes.SOFT_POSITION


class PositionSaturation(LimitedJoints):
    """Position commands clipped to the hard limits."""

    def enforce(self, period: float, first: int, last: int) -> int:
        """See `LimitedJoints.enforce`."""
        mask = 0
        position, command, previous = self.position, self.command, self.previous
        min_position, max_position = self.min_position, self.max_position
        max_velocity = self.max_velocity
        for i in range(first, last):
            lowest = min_position[i]
            highest = max_position[i]
            low = lowest
            high = highest
            speed = max_velocity[i]
            if speed == speed:  # not NaN: there is such a limit
                before = previous[i]
                if before != before:  # NaN: no command yet
                    before = position[i]
                step = speed * period
                low = before - step
                if low < lowest:
                    low = lowest
                high = before + step
                if highest < high:
                    high = highest
            asked = command[i]
            given = asked
            if given < low:
                given = low
            if high < given:
                given = high
            previous[i] = given
            if given < asked or asked < given:
                command[i] = given
                self.asked[i] = asked
                mask |= _BIT << (i - first)
                if given == lowest or given == highest:
                    self.reason[i] = _POSITION
                else:
                    self.reason[i] = _VELOCITY
        return mask


class PositionSoftLimits(SoftLimitedJoints):
    """Position commands that slow down towards the soft limits and stop there."""

    def enforce(self, period: float, first: int, last: int) -> int:
        """See `LimitedJoints.enforce`."""
        mask = 0
        position, command, previous = self.position, self.command, self.previous
        soft_min, soft_max, k_position = self.soft_min, self.soft_max, self.k_position
        min_position, max_position = self.min_position, self.max_position
        max_velocity = self.max_velocity
        free_min, free_max = self.free_min, self.free_max
        for i in range(first, last):
            before = previous[i]
            if before != before:  # NaN: no command yet
                before = position[i]
            speed = max_velocity[i]
            asked = command[i]
            step = speed * period
            if (
                before - step <= asked <= before + step
                and free_min[i] <= before <= free_max[i]
                and min_position[i] <= asked <= max_position[i]
            ):
                previous[i] = asked
                continue  # the usual case
            low_velocity = -speed
            high_velocity = speed
            bound = soft_min[i]
            if bound == bound:  # not NaN: the joint has a range
                gain = -k_position[i]
                low_velocity = gain * (before - bound)
                if low_velocity < -speed:
                    low_velocity = -speed
                if speed < low_velocity:
                    low_velocity = speed
                high_velocity = gain * (before - soft_max[i])
                if high_velocity < -speed:
                    high_velocity = -speed
                if speed < high_velocity:
                    high_velocity = speed
            low = before + low_velocity * period
            if low < min_position[i]:
                low = min_position[i]
            high = before + high_velocity * period
            if max_position[i] < high:
                high = max_position[i]
            given = asked
            if given < low:
                given = low
            if high < given:
                given = high
            previous[i] = given
            if given < asked or asked < given:
                command[i] = given
                self.asked[i] = asked
                mask |= _BIT << (i - first)
                bound = high_velocity if given == high else low_velocity
                if given == min_position[i] or given == max_position[i]:
                    self.reason[i] = _POSITION
                elif -speed < bound < speed:
                    self.reason[i] = _SOFT_POSITION
                else:
                    self.reason[i] = _VELOCITY
        return mask
