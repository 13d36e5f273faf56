"""The handles that keep commands of each kind within the limits of a joint.

The equations are in `limited_joints` and `rate_limits`.

Source: ros_control@633c374 joint_limits_interface.h; differs: clamps are counted,
invalid limits are refused, and the saturation handle of velocities can be reset. The
rate limits have no original.
"""

from math import inf
from sys import float_info
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import (
    JointLimitsHandle,
    SoftLimitsHandle,
)
from station.core.hardware.limits.limited_joints import (
    EffortSaturation,
    EffortSoftLimits,
    LimitedJoints,
    PositionSaturation,
    PositionSoftLimits,
    VelocitySaturation,
    VelocitySoftLimits,
)
from station.core.hardware.limits.rate_limits import (
    PositionRateLimits,
    VelocityRateLimits,
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


class PositionJointRateLimitsHandle(JointLimitsHandle):
    """Limit the velocity, acceleration and jerk of position commands, and their range.

    The first command after construction or `reset` starts from the measured position
    and velocity. A period of 0 or less repeats the last command. Position commands are
    in [rad or m]. All limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = PositionRateLimits
    unlimited: ClassVar[float] = inf


class VelocityJointRateLimitsHandle(JointLimitsHandle):
    """Limit the acceleration and jerk of velocity commands, and the joint's range.

    The range is that of the measured position. The first command after construction
    or `reset` starts from the measured velocity. A period of 0 or less repeats the last
    command. Velocity commands are in [rad/s or m/s]. All limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = VelocityRateLimits
    unlimited: ClassVar[float] = inf
