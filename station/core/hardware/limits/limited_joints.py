"""Saturation and soft limits of the commands of n joints.

NaN stands for a limit that a joint does not have; every comparison ignores it. A
command of NaN passes through. In the equations, `p` and `v` are measured position and
velocity, `prev` is the command of the last cycle, and `clip(x, a, b) = min(max(x, a),
b)`. They give the lowest command; the equation of the highest one is mirrored.

| commands, limits       | lowest command                                             |
|------------------------|------------------------------------------------------------|
| efforts, saturation    | `-e_max`; 0 if `p < p_min` or `v < -v_max`                 |
| efforts, soft          | `clip(-k_v*(v - v_low), -e_max, e_max)` with the bound     |
|                        | `v_low = clip(-k_p*(p - soft_min), -v_max, v_max)`         |
| velocities, saturation | `max(prev - a_max*period, -v_max)`; at first `prev` is 0   |
| velocities, soft       | `max(v - a_max*period,`                                    |
|                        | `clip(-k_p*(p - soft_min), -v_max, v_max))`                |
| positions, saturation  | `max(prev - v_max*period, p_min)`                          |
| positions, soft        | `max(prev + clip(-k_p*(prev - soft_min), -v_max, v_max)`   |
|                        | `*period, p_min)`; at first `prev` is the measured position|

A term is left out if the joint lacks its limit: without position limits, the velocity
bounds of soft limits are `-v_max` and `v_max`. Soft limits of velocities take the
largest float for a missing `v_max`. Only soft limits of efforts use `k_v`.

Source: ros_control@633c374 joint_limits_interface.h, the six handles of limits.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Protocol

from station.memory.doubles import Storage, own

POSITION, VELOCITY, ACCELERATION, JERK, EFFORT, SOFT_POSITION = range(6)
"""Codes of the limits that change a command, in the order of `ClampReason`."""
MOST_JOINTS = 62
"""Largest number of joints in a group: a mask has one bit for each."""
LIMITS = (
    "min_position",
    "max_position",
    "max_velocity",
    "max_acceleration",
    "max_jerk",
    "max_effort",
    "soft_min",
    "soft_max",
    "k_position",
    "k_velocity",
)
"""Names of the views of limits and gains in a group."""
MEMORY = ("previous", "velocity_before", "acceleration_before")
"""Names of the views in which a group remembers the last cycle."""

# As C numbers, by the .pxd; the bit with all 64 that a mask has.
_BIT = 1
_POSITION = POSITION
_VELOCITY = VELOCITY
_ACCELERATION = ACCELERATION
_EFFORT = EFFORT
_SOFT_POSITION = SOFT_POSITION
_INFINITY = float("inf")


class LimitedJoints:
    """The commands of n joints, their limits, and the memory of the last cycle.

    Args:
        views: Numbers by name, shape (n,) each: `position`, `velocity` and `command` of
            the joints; the views named in `LIMITS` and `MEMORY`; `asked` and `reason`,
            which receive, for each joint whose command was changed, the command before
            and the code of the limit.
    """

    def __init__(self, views: Mapping[str, Storage]) -> None:
        self.position = views["position"]
        self.velocity = views["velocity"]
        self.command = views["command"]
        self.min_position = views["min_position"]
        self.max_position = views["max_position"]
        self.max_velocity = views["max_velocity"]
        self.max_acceleration = views["max_acceleration"]
        self.max_jerk = views["max_jerk"]
        self.max_effort = views["max_effort"]
        self.soft_min = views["soft_min"]
        self.soft_max = views["soft_max"]
        self.k_position = views["k_position"]
        self.k_velocity = views["k_velocity"]
        self.previous = views["previous"]
        self.velocity_before = views["velocity_before"]
        self.acceleration_before = views["acceleration_before"]
        self.asked = views["asked"]
        self.reason = views["reason"]
        columns = ("soft_min", "soft_max", "max_velocity", "k_position")
        rows = zip(*(views[name] for name in columns), strict=True)
        ranges = [free_range(*row) for row in rows]
        # Between these positions the soft ends are so far away that the largest
        # velocity is allowed for certain, so nothing has to be computed.
        self.free_min = own(low for low, _ in ranges)
        self.free_max = own(high for _, high in ranges)

    def enforce(self, period: float, first: int, last: int) -> int:
        """Replace the commands of joints `first` to `last` - 1 by admissible ones.

        Args:
            period: Time since the last cycle [s].
            first: Index of the first joint.
            last: Index after the last joint, at most `first + MOST_JOINTS`.

        Returns:
            Bit i is set if a limit changed the command of joint `first + i`.
        """
        return 0


def free_range(
    soft_min: float, soft_max: float, speed: float, gain: float
) -> tuple[float, float]:
    """Return the positions between which the soft limits allow the largest velocity.

    Args:
        soft_min: Lower end of the range [rad or m]; NaN if there is none.
        soft_max: Upper end of the range [rad or m].
        speed: Largest velocity [rad/s or m/s].
        gain: Velocity per distance from an end [1/s].

    Returns:
        Lowest and highest position. If there are none, the lower one exceeds the higher
        one, or one of them is NaN.
    """
    # NaN: the joint has no range.
    if soft_min != soft_min:
        return -_INFINITY, _INFINITY
    # No position is known to be free, so every command is computed.
    if not (gain > 0.0 and speed >= 0.0):
        return _INFINITY, -_INFINITY
    way = speed / gain
    # A reserve for rounding; the last term is for numbers near 0.
    way += 1e-9 * (abs(soft_min) + abs(soft_max) + way) + 1e-300
    return soft_min + way, soft_max - way


def approach(distance: float, gain: float, speed: float) -> float:
    """Return the velocity towards an end of a range, `clip(-gain*distance, -v, v)`.

    Args:
        distance: Distance of the joint from that end [rad or m].
        gain: Velocity per distance [1/s].
        speed: Largest velocity [rad/s or m/s]; NaN if there is none.
    """
    velocity = -gain * distance
    if velocity < -speed:
        velocity = -speed
    if speed < velocity:
        velocity = speed
    return velocity


class EffortSaturation(LimitedJoints):
    """Effort commands clipped to the hard limits."""

    def enforce(self, period: float, first: int, last: int) -> int:
        """See `LimitedJoints.enforce`."""
        mask = 0
        position, velocity, command = self.position, self.velocity, self.command
        min_position, max_position = self.min_position, self.max_position
        max_velocity, max_effort = self.max_velocity, self.max_effort
        for i in range(first, last):
            high = max_effort[i]
            low = -high
            p = position[i]
            # Beyond the range only efforts that lead back are admitted.
            if p < min_position[i]:
                low = 0.0
            elif p > max_position[i]:
                high = 0.0
            v = velocity[i]
            speed = max_velocity[i]
            if v < -speed:
                low = 0.0
            elif v > speed:
                high = 0.0
            asked = command[i]
            given = asked
            if given < low:
                given = low
            if high < given:
                given = high
            if given < asked or asked < given:
                command[i] = given
                self.asked[i] = asked
                mask |= _BIT << (i - first)
                # The tightest bound is the most useful reason.
                if given == max_effort[i] or given == -max_effort[i]:
                    self.reason[i] = _EFFORT
                elif p < min_position[i] or p > max_position[i]:
                    self.reason[i] = _POSITION
                else:
                    self.reason[i] = _VELOCITY
        return mask


class EffortSoftLimits(LimitedJoints):
    """Effort commands that brake a joint before its soft limits."""

    def enforce(self, period: float, first: int, last: int) -> int:
        """See `LimitedJoints.enforce`."""
        mask = 0
        position, velocity, command = self.position, self.velocity, self.command
        soft_min, soft_max = self.soft_min, self.soft_max
        k_position, k_velocity = self.k_position, self.k_velocity
        max_velocity, max_effort = self.max_velocity, self.max_effort
        free_min, free_max = self.free_min, self.free_max
        for i in range(first, last):
            p = position[i]
            v = velocity[i]
            asked = command[i]
            speed = max_velocity[i]
            effort = max_effort[i]
            damping = -k_velocity[i]
            if (
                -effort <= asked <= effort
                and free_min[i] <= p <= free_max[i]
                and damping * (v + speed) <= asked <= damping * (v - speed)
            ):
                continue  # within the limits
            high_velocity = speed
            low_velocity = -speed
            bound = soft_min[i]
            if bound == bound:  # not NaN: the joint has a range
                gain = k_position[i]
                low_velocity = approach(p - bound, gain, speed)
                high_velocity = approach(p - soft_max[i], gain, speed)
            low = damping * (v - low_velocity)
            if low < -effort:
                low = -effort
            if effort < low:
                low = effort
            high = damping * (v - high_velocity)
            if high < -effort:
                high = -effort
            if effort < high:
                high = effort
            given = asked
            if given < low:
                given = low
            if high < given:
                given = high
            if given < asked or asked < given:
                command[i] = given
                self.asked[i] = asked
                mask |= _BIT << (i - first)
                speed = high_velocity if given == high else low_velocity
                # The braking effort is at its limit, opposite to the commanded effort.
                if (given == effort and asked > 0.0) or (
                    given == -effort and not asked > 0.0
                ):
                    self.reason[i] = _EFFORT
                elif -max_velocity[i] < speed < max_velocity[i]:
                    self.reason[i] = _SOFT_POSITION
                else:
                    self.reason[i] = _VELOCITY
        return mask


class VelocitySoftLimits(LimitedJoints):
    """Velocity commands that slow down towards the soft limits.

    Args:
        views: See `LimitedJoints`.
        follows_commands: Whether commands accelerate from the command of the last cycle
            rather than from the measured velocity.
    """

    def __init__(
        self,
        views: Mapping[str, Storage],
        follows_commands: bool = False,  # noqa: FBT001, FBT002 - for the compiler
    ) -> None:
        super().__init__(views)
        self.before = self.previous if follows_commands else views["velocity"]

    def enforce(self, period: float, first: int, last: int) -> int:
        """See `LimitedJoints.enforce`."""
        mask = 0
        position, command, previous = self.position, self.command, self.previous
        soft_min, soft_max, k_position = self.soft_min, self.soft_max, self.k_position
        max_velocity, max_acceleration = self.max_velocity, self.max_acceleration
        free_min, free_max = self.free_min, self.free_max
        for i in range(first, last):
            speed = max_velocity[i]
            range_low = -speed
            range_high = speed
            p = position[i]
            if not free_min[i] <= p <= free_max[i]:
                bound = soft_min[i]
                if bound == bound:  # not NaN: the joint has a range
                    gain = k_position[i]
                    range_low = approach(p - bound, gain, speed)
                    range_high = approach(p - soft_max[i], gain, speed)
            low = range_low
            high = range_high
            acceleration = max_acceleration[i]
            if acceleration == acceleration:  # not NaN: there is such a limit
                step = acceleration * period
                before = self.before[i]
                low = before - step
                if low < range_low:
                    low = range_low
                high = before + step
                if range_high < high:
                    high = range_high
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
                if given != range_low and given != range_high:
                    self.reason[i] = _ACCELERATION
                elif given == speed or given == -speed:
                    self.reason[i] = _VELOCITY
                else:
                    self.reason[i] = _SOFT_POSITION
        return mask


VelocitySaturation = partial(VelocitySoftLimits, follows_commands=True)
"""Velocity commands clipped to the hard limits; they accelerate from the command of the
last cycle."""


class PositionLimits(LimitedJoints):
    """Position commands that keep to the range, and slow down before soft limits."""

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
                continue  # within the limits
            low_velocity = -speed
            high_velocity = speed
            bound = soft_min[i]
            if bound == bound:  # not NaN: the joint has a range
                gain = k_position[i]
                low_velocity = approach(before - bound, gain, speed)
                high_velocity = approach(before - soft_max[i], gain, speed)
            low = min_position[i]
            high = max_position[i]
            if speed == speed:  # not NaN: there is such a limit
                bound = before + low_velocity * period
                if not bound < low:
                    low = bound
                bound = before + high_velocity * period
                if not high < bound:
                    high = bound
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


class LimitedJoint(Protocol):
    """A joint that enforces its limits in its own way."""

    def enforce_limits(self, period: float) -> None:
        """Enforce the limits of the joint.

        Args:
            period: Time since the last cycle [s], > 0.
        """


class LimitedRun:
    """Joints that follow one another in a group, and are limited in one call.

    Args:
        joints: The limits of the group's joints, if they use the robot's memory; None
            if values are copied in and out.
        enforce: Calls `joints.enforce`, on copies of the values where necessary.
        first: Index of the first joint in the group.
        last: Index after the last joint.
        count: Counts the changed commands; its argument has one bit for each joint.
    """

    def __init__(
        self,
        joints: LimitedJoints | None,
        enforce: Callable[[float, int, int], int],
        first: int,
        last: int,
        count: Callable[[int], None],
    ) -> None:
        self.joints = joints
        self.enforce = enforce
        self.first = first
        self.last = last
        self.count = count


class EnforcedLimits:
    """All limits of one kind of command.

    Attributes:
        runs: Joints that are limited together.
        singles: Joints that are limited one by one.
    """

    def __init__(self) -> None:
        self.runs: list[LimitedRun] = []
        self.singles: list[LimitedJoint] = []

    def enforce(self, period: float) -> None:
        """Enforce all limits.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        for run in self.runs:
            joints = run.joints
            if joints is not None:
                mask = joints.enforce(period, run.first, run.last)
            else:
                mask = run.enforce(period, run.first, run.last)
            if mask:
                run.count(mask)
        for single in self.singles:
            single.enforce_limits(period)
