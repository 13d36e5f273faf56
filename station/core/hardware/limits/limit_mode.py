"""Choose the handles that enforce a joint's limits."""

from enum import Enum

from station.core.errors import ParameterError
from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.limits.effort_joint_limits import (
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
)
from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import JointLimitsHandle
from station.core.hardware.limits.position_joint_limits import (
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
)
from station.core.hardware.limits.rate_joint_limits import (
    PositionJointRateLimitsHandle,
    VelocityJointRateLimitsHandle,
)
from station.core.hardware.limits.velocity_joint_limits import (
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
)
from station.core.parameters import Parameters

_KEY = "limit_mode"


class LimitMode(Enum):
    """How commands are limited.

    Attributes:
        ROS_CONTROL: Soft limits where there are some, saturation elsewhere.
        RATE: Against the command before, acceleration and jerk included; see
            `rate_joint_limits`. Efforts have no rate: they are saturated.
    """

    ROS_CONTROL = "ros_control"
    RATE = "rate"

    @classmethod
    def from_parameters(cls, params: Parameters) -> "LimitMode":
        """Return a robot's `limit_mode`, `ros_control` when absent.

        Args:
            params: The robot's namespace.

        Raises:
            ParameterError: It is something else.
        """
        value = params.get_str(_KEY, cls.ROS_CONTROL.value)
        modes = {mode.value: mode for mode in cls}
        if value not in modes:
            raise ParameterError(
                f"Parameter '{params.resolve(_KEY)}' is {value!r}; it must be one of "
                f"{', '.join(modes)}.",
                remedy="Correct the configuration.",
                details={"parameter": params.resolve(_KEY)},
            )
        return modes[value]


def make_limits_handle(
    mode: LimitMode,
    quantity: str,
    joint: JointHandle,
    limits: JointLimits,
    soft_limits: SoftJointLimits | None,
) -> JointLimitsHandle:
    """Return what enforces the limits of one kind of command of a joint.

    Args:
        mode: How commands are limited.
        quantity: "position", "velocity" or "effort".
        joint: The joint's state and command.
        limits: Its limits.
        soft_limits: Its soft limits; None where it has none.

    Raises:
        JointLimitsError: The limits are contradictory, or one is missing without which
            the commands cannot be limited.
    """
    if mode is LimitMode.RATE and quantity == "position":
        return PositionJointRateLimitsHandle(joint, limits)
    if mode is LimitMode.RATE and quantity == "velocity":
        return VelocityJointRateLimitsHandle(joint, limits)
    if soft_limits is None or mode is LimitMode.RATE:
        if quantity == "position":
            return PositionJointSaturationHandle(joint, limits)
        if quantity == "velocity":
            return VelocityJointSaturationHandle(joint, limits)
        return EffortJointSaturationHandle(joint, limits)
    if quantity == "position":
        return PositionJointSoftLimitsHandle(joint, limits, soft_limits)
    if quantity == "velocity":
        return VelocityJointSoftLimitsHandle(joint, limits, soft_limits)
    return EffortJointSoftLimitsHandle(joint, limits, soft_limits)
