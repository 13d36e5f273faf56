"""Joint limits, and the handles that enforce them.

`RobotHW.write` enforces them, after the controllers. The equations are in
`limited_joints` and `rate_limits`.
"""

from station.core.hardware.limits.joint_limits import (
    JointLimits as JointLimits,
    JointLimitsError as JointLimitsError,
    SoftJointLimits as SoftJointLimits,
    joint_limits_from_parameters as joint_limits_from_parameters,
    joint_limits_from_urdf as joint_limits_from_urdf,
    limits_without_effect as limits_without_effect,
    soft_joint_limits_from_parameters as soft_joint_limits_from_parameters,
    soft_joint_limits_from_urdf as soft_joint_limits_from_urdf,
)
from station.core.hardware.limits.joint_limits_handle import (
    Clamp as Clamp,
    ClampReason as ClampReason,
    EffortJointSaturationHandle as EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle as EffortJointSoftLimitsHandle,
    JointLimitsHandle as JointLimitsHandle,
    LimitMode as LimitMode,
    PositionJointRateLimitsHandle as PositionJointRateLimitsHandle,
    PositionJointSaturationHandle as PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle as PositionJointSoftLimitsHandle,
    VelocityJointRateLimitsHandle as VelocityJointRateLimitsHandle,
    VelocityJointSaturationHandle as VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle as VelocityJointSoftLimitsHandle,
    make_limits_handle as make_limits_handle,
)
from station.core.hardware.limits.joint_limits_interface import (
    EffortJointSaturationInterface as EffortJointSaturationInterface,
    EffortJointSoftLimitsInterface as EffortJointSoftLimitsInterface,
    JointLimitsInterface as JointLimitsInterface,
    PositionJointRateLimitsInterface as PositionJointRateLimitsInterface,
    PositionJointSaturationInterface as PositionJointSaturationInterface,
    PositionJointSoftLimitsInterface as PositionJointSoftLimitsInterface,
    VelocityJointRateLimitsInterface as VelocityJointRateLimitsInterface,
    VelocityJointSaturationInterface as VelocityJointSaturationInterface,
    VelocityJointSoftLimitsInterface as VelocityJointSoftLimitsInterface,
)
