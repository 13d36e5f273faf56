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

from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import (
    JointLimitsHandle,
    SoftLimitsHandle,
)
from station.core.hardware.limits.limited_joints import (
    LimitedJoints,
    VelocitySaturation,
    VelocitySoftLimits,
)


class VelocityJointSaturationHandle(JointLimitsHandle):
    """Clip a velocity command to the velocity and acceleration bounds.

    Velocity commands are in [rad/s or m/s]. The joint needs velocity limits;
    acceleration limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = VelocitySaturation
    required: ClassVar[tuple[str, ...]] = ("velocity",)
    first_previous: ClassVar[float] = 0.0


class VelocityJointSoftLimitsHandle(SoftLimitsHandle):
    """Slow a velocity command down towards the soft limits.

    Velocity commands are in [rad/s or m/s]. All limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = VelocitySoftLimits

    @override
    def find_bounds(
        self, limits: JointLimits, soft_limits: SoftJointLimits | None
    ) -> dict[str, float]:
        bounds = super().find_bounds(limits, soft_limits)
        # An infinite command becomes a finite one, as in the original.
        if not bounds["max_velocity"] < float_info.max:
            bounds["max_velocity"] = float_info.max
        return bounds
