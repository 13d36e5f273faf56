"""Choose the handles that enforce a joint's limits."""

from collections.abc import Callable, Mapping
from enum import Enum

from station.core.errors import ParameterError
from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import JointLimitsHandle
from station.core.hardware.limits.limit_handles import (
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
    PositionJointRateLimitsHandle,
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
    VelocityJointRateLimitsHandle,
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
)
from station.core.parameters import Parameters

_KEY = "limit_mode"
_MakeHandle = Callable[[JointHandle, JointLimits], JointLimitsHandle]
_SATURATION: Mapping[str, _MakeHandle] = {
    "position": PositionJointSaturationHandle,
    "velocity": VelocityJointSaturationHandle,
    "effort": EffortJointSaturationHandle,
}
_SOFT: Mapping[
    str, Callable[[JointHandle, JointLimits, SoftJointLimits], JointLimitsHandle]
] = {
    "position": PositionJointSoftLimitsHandle,
    "velocity": VelocityJointSoftLimitsHandle,
    "effort": EffortJointSoftLimitsHandle,
}
_RATE: Mapping[str, _MakeHandle] = {
    "position": PositionJointRateLimitsHandle,
    "velocity": VelocityJointRateLimitsHandle,
    "effort": EffortJointSaturationHandle,
}


class LimitMode(Enum):
    """The methods of limiting commands.

    Attributes:
        ROS_CONTROL: By the soft limits of a joint that has them, otherwise by
            saturation at its hard limits.
        RATE: Against the command of the last cycle, acceleration and jerk included;
            see `rate_limits`. Efforts have no rate and are saturated.
    """

    ROS_CONTROL = "ros_control"
    RATE = "rate"

    @classmethod
    def from_parameters(cls, params: Parameters) -> "LimitMode":
        """Return a robot's `limit_mode`, which is `ros_control` when absent.

        Args:
            params: The robot's namespace.

        Raises:
            ParameterError: The parameter has another value than the modes' names.
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
    """Return the handle that enforces the limits of one kind of command of a joint.

    Args:
        mode: How commands are limited.
        quantity: "position", "velocity" or "effort".
        joint: The joint's state and command.
        limits: The joint's limits.
        soft_limits: The joint's soft limits; None if it has none.

    Raises:
        JointLimitsError: The limits contradict each other, or a limit that the handle
            needs is missing.
    """
    if mode is LimitMode.RATE:
        return _RATE[quantity](joint, limits)
    if soft_limits is None:
        return _SATURATION[quantity](joint, limits)
    return _SOFT[quantity](joint, limits, soft_limits)
