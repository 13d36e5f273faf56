"""Keep velocity commands within position, velocity and acceleration limits.

With `prev` the command of the last cycle (0 in the first one and after `reset`), the
measured position `p` and velocity `v`, `clip(x, a, b) = min(max(x, a), b)`:

| handle     | lowest command                                                         |
|------------|------------------------------------------------------------------------|
| saturation | `max(prev - a_max*period, -v_max)`, without acceleration limit `-v_max`|
| soft       | `max(v - a_max*period, clip(-k_p*(p - soft_min), -v_max, v_max))`      |

and the same mirrored for the highest one. In the soft handle, a joint without
acceleration limits has no first term, a joint without position limits has `-v_max` as
the second one, and a joint without velocity limits has the largest float as `v_max`.
`k_velocity` is not used.

Source: ros_control@633c374 joint_limits_interface.h, VelocityJointSaturationHandle and
VelocityJointSoftLimitsHandle; differs: clamps are counted, invalid limits are refused,
and the saturation handle can be reset.
"""

from sys import float_info
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import (
    ClampReason,
    JointLimitsHandle,
    SoftLimitsHandle,
)
from station.core.hardware.limits.saturate import soft_velocity_bound


class VelocityJointSaturationHandle(JointLimitsHandle):
    """Clip a velocity command to the velocity and acceleration bounds.

    Velocity commands are in [rad/s or m/s]. The joint needs velocity limits;
    acceleration limits are optional.
    """

    required: ClassVar[tuple[str, ...]] = ("velocity",)

    def __init__(self, joint: JointHandle, limits: JointLimits) -> None:
        super().__init__(joint, limits)
        self._previous: float = 0.0

    @override
    def enforce_limits(self, period: float) -> None:
        low = -self._max_velocity
        high = self._max_velocity
        if self._has_acceleration_limits:
            step = self._max_acceleration * period
            low = self._previous - step
            if low < -self._max_velocity:
                low = -self._max_velocity
            high = self._previous + step
            if self._max_velocity < high:
                high = self._max_velocity
        asked = self._joint.get_command()
        given = asked
        if given < low:
            given = low
        if high < given:
            given = high
        self._joint.set_command(given)
        self._previous = given
        if given < asked or asked < given:
            self._count_clamp(asked, given, self._reason_for(given))

    @override
    def reset(self) -> None:
        self._previous = 0.0

    def _reason_for(self, given: float) -> ClampReason:
        if abs(given) == self._max_velocity:
            return ClampReason.VELOCITY
        return ClampReason.ACCELERATION


class VelocityJointSoftLimitsHandle(SoftLimitsHandle):
    """Slow a velocity command down towards the soft limits.

    Velocity commands are in [rad/s or m/s]. All limits are optional.
    """

    def __init__(
        self, joint: JointHandle, limits: JointLimits, soft_limits: SoftJointLimits
    ) -> None:
        super().__init__(joint, limits, soft_limits)
        # An infinite command becomes a finite one, as in the original.
        self._max_velocity = min(self._max_velocity, float_info.max)

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        max_velocity = self._max_velocity
        low = -max_velocity
        high = max_velocity
        if self._has_position_limits:
            position = joint.get_position()
            low = soft_velocity_bound(
                position, self._soft_min, self._k_position, max_velocity
            )
            high = soft_velocity_bound(
                position, self._soft_max, self._k_position, max_velocity
            )
        range_low = low
        range_high = high
        if self._has_acceleration_limits:
            velocity = joint.get_velocity()
            step = self._max_acceleration * period
            low = velocity - step
            if low < range_low:
                low = range_low
            high = velocity + step
            if range_high < high:
                high = range_high
        asked = joint.get_command()
        given = asked
        if given < low:
            given = low
        if high < given:
            given = high
        joint.set_command(given)
        if given < asked or asked < given:
            in_range = given in (range_low, range_high)
            self._count_clamp(asked, given, self._reason_for(given, in_range=in_range))

    def _reason_for(self, given: float, *, in_range: bool) -> ClampReason:
        if not in_range:
            return ClampReason.ACCELERATION
        if abs(given) == self._max_velocity:
            return ClampReason.VELOCITY
        return ClampReason.SOFT_POSITION
