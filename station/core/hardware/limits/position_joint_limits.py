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

from sys import float_info
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import (
    JointLimitsHandle,
    SoftLimitsHandle,
)
from station.core.hardware.limits.limited_joints import (
    LimitedJoints,
    PositionSaturation,
    PositionSoftLimits,
)


class PositionJointSaturationHandle(JointLimitsHandle):
    """Clip a position command to the position range and the velocity bound.

    Position commands are in [rad or m]. Position and velocity limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = PositionSaturation

    @override
    def find_bounds(
        self, limits: JointLimits, soft_limits: SoftJointLimits | None
    ) -> dict[str, float]:
        bounds = super().find_bounds(limits, soft_limits)
        # An infinite command becomes a finite one, as in the original.
        if not bounds["min_position"] > -float_info.max:
            bounds["min_position"] = -float_info.max
        if not bounds["max_position"] < float_info.max:
            bounds["max_position"] = float_info.max
        return bounds


class PositionJointSoftLimitsHandle(SoftLimitsHandle):
    """Slow a position command down towards the soft limits, and stop it there.

    The velocity bound compares with the last command, not with the measured position,
    which lags behind. It does not hold, therefore, while the joint recovers from a
    large tracking error. `k_velocity` is not used. Position commands are in [rad or m].
    The joint needs velocity limits, and position limits unless it is continuous.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = PositionSoftLimits
    required: ClassVar[tuple[str, ...]] = ("velocity",)
