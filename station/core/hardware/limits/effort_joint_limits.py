"""Keep effort commands within position, velocity and effort limits.

With the measured position `p` and velocity `v`, `clip(x, a, b) = min(max(x, a), b)`:

| handle     | lowest command                                                         |
|------------|------------------------------------------------------------------------|
| saturation | `-e_max`; 0 if `p < p_min` or `v < -v_max`                             |
| soft       | `clip(-k_v*(v - v_low), -e_max, e_max)` with the velocity bound        |
|            | `v_low = clip(-k_p*(p - soft_min), -v_max, v_max)`                     |

and the same mirrored for the highest one (saturation: `e_max`; 0 if `p > p_max` or
`v > v_max`; soft: with `soft_max`). Without position limits the velocity bounds of the
soft handle are `-v_max` and `v_max`.

Source: ros_control@633c374 joint_limits_interface.h, EffortJointSaturationHandle and
EffortJointSoftLimitsHandle; differs: clamps are counted, invalid limits are refused.
"""

from typing import ClassVar

from typing_extensions import override

from station.core.hardware.limits.joint_limits_handle import (
    ClampReason,
    JointLimitsHandle,
    SoftLimitsHandle,
)
from station.core.hardware.limits.saturate import saturate, soft_velocity_bound


class EffortJointSaturationHandle(JointLimitsHandle):
    """Clip an effort command; beyond a limit, admit only an effort that points back.

    Effort commands are in [N*m or N]. The joint needs velocity and effort limits;
    position limits are optional.
    """

    required: ClassVar[tuple[str, ...]] = ("velocity", "effort")

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        low = -self._max_effort
        high = self._max_effort
        if self._has_position_limits:
            position = joint.get_position()
            if position < self._min_position:
                low = 0.0
            elif position > self._max_position:
                high = 0.0
        velocity = joint.get_velocity()
        if velocity < -self._max_velocity:
            low = 0.0
        elif velocity > self._max_velocity:
            high = 0.0
        asked = joint.get_command()
        given = asked
        if given < low:
            given = low
        if high < given:
            given = high
        joint.set_command(given)
        if given < asked or asked < given:
            self._count_clamp(asked, given, self._reason_for(given))

    def _reason_for(self, given: float) -> ClampReason:
        if abs(given) == self._max_effort:
            return ClampReason.EFFORT
        if self._has_position_limits:
            position = self._joint.get_position()
            if not self._min_position <= position <= self._max_position:
                return ClampReason.POSITION
        return ClampReason.VELOCITY


class EffortJointSoftLimitsHandle(SoftLimitsHandle):
    """Brake a joint in proportion to its excess velocity before the soft limits.

    Effort commands are in [N*m or N]. The joint needs velocity and effort limits, and
    position limits unless it is continuous.
    """

    required: ClassVar[tuple[str, ...]] = ("velocity", "effort")

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        max_velocity = self._max_velocity
        low_velocity = -max_velocity
        high_velocity = max_velocity
        if self._has_position_limits:
            position = joint.get_position()
            low_velocity = soft_velocity_bound(
                position, self._soft_min, self._k_position, max_velocity
            )
            high_velocity = soft_velocity_bound(
                position, self._soft_max, self._k_position, max_velocity
            )
        velocity = joint.get_velocity()
        max_effort = self._max_effort
        low = saturate(
            -self._k_velocity * (velocity - low_velocity), -max_effort, max_effort
        )
        high = saturate(
            -self._k_velocity * (velocity - high_velocity), -max_effort, max_effort
        )
        asked = joint.get_command()
        given = asked
        if given < low:
            given = low
        if high < given:
            given = high
        joint.set_command(given)
        if given < asked or asked < given:
            bound = high_velocity if given == high else low_velocity
            self._count_clamp(asked, given, self._reason_for(asked, given, bound))

    def _reason_for(
        self, asked: float, given: float, velocity_bound: float
    ) -> ClampReason:
        # Braking at full effort points away from the effort that was asked for.
        if abs(given) == self._max_effort and (given > 0.0) == (asked > 0.0):
            return ClampReason.EFFORT
        if abs(velocity_bound) < self._max_velocity:
            return ClampReason.SOFT_POSITION
        return ClampReason.VELOCITY
