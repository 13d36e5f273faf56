"""Keep position commands within position and velocity limits.

With `prev` the command of the last cycle (the measured position in the first cycle and
after `reset`), `clip(x, a, b) = min(max(x, a), b)`:

| handle     | lowest command                                                         |
|------------|------------------------------------------------------------------------|
| saturation | `max(prev - v_max*period, p_min)`, without velocity limit `p_min`      |
| soft       | `max(prev + clip(-k_p*(prev-soft_min), -v_max, v_max)*period, p_min)`  |

and the same with `+v_max`, `p_max`, `soft_max` and `min` for the highest one. Without
position limits, `p_min`, `p_max` and the soft bounds are not used.

Source: ros_control@633c374 joint_limits_interface.h, PositionJointSaturationHandle and
PositionJointSoftLimitsHandle; differs: clamps are counted, invalid limits are refused.
"""

from math import nan
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


class PositionJointSaturationHandle(JointLimitsHandle):
    """Clip a position command to the position range and the velocity bound.

    Position commands are in [rad or m]. Position and velocity limits are optional.
    """

    def __init__(self, joint: JointHandle, limits: JointLimits) -> None:
        super().__init__(joint, limits)
        # An infinite command becomes a finite one, as in the original.
        self._min_position = max(self._min_position, -float_info.max)
        self._max_position = min(self._max_position, float_info.max)
        self._has_velocity_limits: bool = limits.max_velocity is not None
        self._previous: float = nan

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        previous = self._previous
        if previous != previous:  # NaN stands for no command yet
            previous = joint.get_position()
        low = self._min_position
        high = self._max_position
        if self._has_velocity_limits:
            step = self._max_velocity * period
            low = previous - step
            if low < self._min_position:
                low = self._min_position
            high = previous + step
            if self._max_position < high:
                high = self._max_position
        asked = joint.get_command()
        given = asked
        if given < low:
            given = low
        if high < given:
            given = high
        joint.set_command(given)
        self._previous = given
        if given < asked or asked < given:
            self._count_clamp(asked, given, self._reason_for(given))

    @override
    def reset(self) -> None:
        self._previous = nan

    def _reason_for(self, given: float) -> ClampReason:
        if given in (self._min_position, self._max_position):
            return ClampReason.POSITION
        return ClampReason.VELOCITY


class PositionJointSoftLimitsHandle(SoftLimitsHandle):
    """Slow a position command down towards the soft limits, and stop it there.

    The velocity bound compares with the last command, not with the measured position,
    which lags behind. It does not hold, therefore, while the joint recovers from a
    large tracking error. `k_velocity` is not used. Position commands are in [rad or m].
    The joint needs velocity limits, and position limits unless it is continuous.
    """

    required: ClassVar[tuple[str, ...]] = ("velocity",)

    def __init__(
        self, joint: JointHandle, limits: JointLimits, soft_limits: SoftJointLimits
    ) -> None:
        super().__init__(joint, limits, soft_limits)
        self._previous: float = nan

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        previous = self._previous
        if previous != previous:  # NaN stands for no command yet
            previous = joint.get_position()
        max_velocity = self._max_velocity
        low_velocity = -max_velocity
        high_velocity = max_velocity
        if self._has_position_limits:
            low_velocity = soft_velocity_bound(
                previous, self._soft_min, self._k_position, max_velocity
            )
            high_velocity = soft_velocity_bound(
                previous, self._soft_max, self._k_position, max_velocity
            )
        low = previous + low_velocity * period
        high = previous + high_velocity * period
        if self._has_position_limits:
            if low < self._min_position:
                low = self._min_position
            if self._max_position < high:
                high = self._max_position
        asked = joint.get_command()
        given = asked
        if given < low:
            given = low
        if high < given:
            given = high
        joint.set_command(given)
        self._previous = given
        if given < asked or asked < given:
            bound = high_velocity if given == high else low_velocity
            self._count_clamp(asked, given, self._reason_for(given, bound))

    @override
    def reset(self) -> None:
        self._previous = nan

    def _reason_for(self, given: float, velocity_bound: float) -> ClampReason:
        if self._has_position_limits:
            if given in (self._min_position, self._max_position):
                return ClampReason.POSITION
            if abs(velocity_bound) < self._max_velocity:
                return ClampReason.SOFT_POSITION
        return ClampReason.VELOCITY
