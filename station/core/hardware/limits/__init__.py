"""Joint limits, and the handles that enforce them.

The handles act in `RobotHW.write`, after the controllers. The equations are in
`limited_joints` and `rate_limits`.
"""

from station.core.hardware.limits.joint_limits import (
    JointLimits,
    JointLimitsError,
    SoftJointLimits,
)
from station.core.hardware.limits.joint_limits_handle import (
    Clamp,
    ClampReason,
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
    JointLimitsHandle,
    LimitMode,
    PositionJointRateLimitsHandle,
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
    VelocityJointRateLimitsHandle,
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
    make_limits_handle,
)
from station.core.hardware.limits.joint_limits_interface import (
    EffortJointSaturationInterface,
    EffortJointSoftLimitsInterface,
    JointLimitsInterface,
    PositionJointRateLimitsInterface,
    PositionJointSaturationInterface,
    PositionJointSoftLimitsInterface,
    VelocityJointRateLimitsInterface,
    VelocityJointSaturationInterface,
    VelocityJointSoftLimitsInterface,
)
from station.core.hardware.limits.limit_sources import (
    joint_limits_from_parameters,
    joint_limits_from_urdf,
    limits_without_effect,
    soft_joint_limits_from_parameters,
    soft_joint_limits_from_urdf,
)

__all__ = [
    "Clamp",
    "ClampReason",
    "EffortJointSaturationHandle",
    "EffortJointSaturationInterface",
    "EffortJointSoftLimitsHandle",
    "EffortJointSoftLimitsInterface",
    "JointLimits",
    "JointLimitsError",
    "JointLimitsHandle",
    "JointLimitsInterface",
    "LimitMode",
    "PositionJointRateLimitsHandle",
    "PositionJointRateLimitsInterface",
    "PositionJointSaturationHandle",
    "PositionJointSaturationInterface",
    "PositionJointSoftLimitsHandle",
    "PositionJointSoftLimitsInterface",
    "SoftJointLimits",
    "VelocityJointRateLimitsHandle",
    "VelocityJointRateLimitsInterface",
    "VelocityJointSaturationHandle",
    "VelocityJointSaturationInterface",
    "VelocityJointSoftLimitsHandle",
    "VelocityJointSoftLimitsInterface",
    "joint_limits_from_parameters",
    "joint_limits_from_urdf",
    "limits_without_effect",
    "make_limits_handle",
    "soft_joint_limits_from_parameters",
    "soft_joint_limits_from_urdf",
]
