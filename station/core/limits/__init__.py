"""Joint limits: what a joint may do, and the handles that see to it."""

from station.core.limits.joint_limits import (
    JointLimits,
    JointLimitsError,
    SoftJointLimits,
)

__all__ = ["JointLimits", "JointLimitsError", "SoftJointLimits"]
