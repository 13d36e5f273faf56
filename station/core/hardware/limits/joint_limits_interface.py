"""Enforce the limits of all joints of one kind of command in one call.

Source: ros_control@633c374 joint_limits_interface.h, JointLimitsInterface and the six
interfaces derived from it; differs: every interface can be reset, and an unknown joint
raises `ResourceNotFoundError` as in every other interface.
"""

from typing import TypeVar

from typing_extensions import override

from station.core.hardware.interfaces.resource_manager import ResourceManager
from station.core.hardware.limits.effort_joint_limits import (
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
)
from station.core.hardware.limits.joint_limits_handle import Clamp, JointLimitsHandle
from station.core.hardware.limits.position_joint_limits import (
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
)
from station.core.hardware.limits.velocity_joint_limits import (
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
)

L = TypeVar("L", bound=JointLimitsHandle)


class JointLimitsInterface(ResourceManager[L]):
    """Hold the limit handles of a robot, filled at start and enforced in `write`."""

    def __init__(self) -> None:
        super().__init__()
        self._enforced: list[L] = []

    @override
    def __init_subclass__(cls) -> None:
        """Name the interface as ros_control does."""
        super().__init_subclass__()
        cls.type_name = f"joint_limits_interface::{cls.__name__}"

    @override
    def register_handle(self, handle: L) -> None:
        super().register_handle(handle)
        self._enforced = self.handles()

    def enforce_limits(self, period: float) -> None:
        """Enforce the limits of all joints. Control thread.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        for handle in self._enforced:
            handle.enforce_limits(period)

    def reset(self) -> None:
        """Forget all previous commands. Control thread, at a cycle boundary."""
        for handle in self._enforced:
            handle.reset()

    @property
    def clamp_count(self) -> int:
        """The number of commands that were changed, over all joints. Any thread."""
        return sum(handle.clamp_count for handle in self._enforced)

    def last_clamps(self) -> list[Clamp]:
        """Return the latest clamp of every joint that had one. Any thread."""
        clamps = [handle.last_clamp for handle in self._enforced]
        return [clamp for clamp in clamps if clamp is not None]


class PositionJointSaturationInterface(
    JointLimitsInterface[PositionJointSaturationHandle]
):
    """Limits of position-controlled joints without soft limits."""


class PositionJointSoftLimitsInterface(
    JointLimitsInterface[PositionJointSoftLimitsHandle]
):
    """Limits of position-controlled joints with soft limits."""


class VelocityJointSaturationInterface(
    JointLimitsInterface[VelocityJointSaturationHandle]
):
    """Limits of velocity-controlled joints without soft limits."""


class VelocityJointSoftLimitsInterface(
    JointLimitsInterface[VelocityJointSoftLimitsHandle]
):
    """Limits of velocity-controlled joints with soft limits."""


class EffortJointSaturationInterface(JointLimitsInterface[EffortJointSaturationHandle]):
    """Limits of effort-controlled joints without soft limits."""


class EffortJointSoftLimitsInterface(JointLimitsInterface[EffortJointSoftLimitsHandle]):
    """Limits of effort-controlled joints with soft limits."""
