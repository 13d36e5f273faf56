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

from station.core.hardware.limits.joint_limits_handle import (
    JointLimitsHandle,
    SoftLimitsHandle,
)
from station.core.hardware.limits.limited_joints import (
    EffortSaturation,
    EffortSoftLimits,
    LimitedJoints,
)


class EffortJointSaturationHandle(JointLimitsHandle):
    """Clip an effort command; beyond a limit, admit only an effort that points back.

    Effort commands are in [N*m or N]. The joint needs velocity and effort limits;
    position limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = EffortSaturation
    required: ClassVar[tuple[str, ...]] = ("velocity", "effort")


class EffortJointSoftLimitsHandle(SoftLimitsHandle):
    """Brake a joint in proportion to its excess velocity before the soft limits.

    Effort commands are in [N*m or N]. The joint needs velocity and effort limits, and
    position limits unless it is continuous.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = EffortSoftLimits
    required: ClassVar[tuple[str, ...]] = ("velocity", "effort")
