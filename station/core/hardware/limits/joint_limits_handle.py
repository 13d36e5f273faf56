"""Enforce the limits of one joint, and count the commands that were changed."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from math import inf
from typing import ClassVar

from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.interfaces.resource_manager import ResourceHandle
from station.core.hardware.limits.joint_limits import (
    JointLimits,
    JointLimitsError,
    SoftJointLimits,
)


class ClampReason(Enum):
    """The limit that changed a command."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    JERK = "jerk"
    EFFORT = "effort"
    SOFT_POSITION = "soft_position"


@dataclass(frozen=True, slots=True)
class Clamp:
    """A command that was changed: the controller's and the one the joint got instead.

    Attributes:
        joint: Name of the joint.
        asked: Command before the limits, in the unit of the joint's command.
        given: Command after the limits, in the same unit.
        reason: The limit that changed the command.
    """

    joint: str
    asked: float
    given: float
    reason: ClampReason


class JointLimitsHandle(ResourceHandle, ABC):
    """Enforce the limits of one joint once per cycle, after the controllers.

    Contract: `enforce_limits` is called by the control thread in `RobotHW.write`, with
    this cycle's state and command in the joint's slots; it allocates nothing unless it
    clamps. `reset` is called on a mode switch, an emergency stop or a recovery. The
    clamp figures may be read by any thread. A NaN command passes through unchanged and
    is not counted, as in the original: the robot and the manager refuse it.

    Args:
        joint: The joint's state and command, in the unit of the joint's command.
        limits: The joint's limits, read once.

    Attributes:
        required: The limits that the joint must have, such as "velocity".
        clamp_count: Number of cycles in which the command was changed, since
            construction.

    Raises:
        JointLimitsError: A required limit is missing, or no command could satisfy the
            limits.
    """

    required: ClassVar[tuple[str, ...]] = ()

    def __init__(self, joint: JointHandle, limits: JointLimits) -> None:
        super().__init__(joint.name)
        for kind in self.required:
            _require_limit(joint.name, kind, getattr(limits, f"max_{kind}"))
        limits.validate(joint.name)
        self._joint: JointHandle = joint
        self._has_position_limits: bool = limits.has_position_limits
        self._has_acceleration_limits: bool = limits.max_acceleration is not None
        self._min_position: float = _or_else(limits.min_position, -inf)
        self._max_position: float = _or_else(limits.max_position, inf)
        self._max_velocity: float = _or_else(limits.max_velocity, inf)
        self._max_acceleration: float = _or_else(limits.max_acceleration, inf)
        self._max_effort: float = _or_else(limits.max_effort, inf)
        self.clamp_count: int = 0
        self._last_clamp: tuple[float, float, ClampReason] | None = None

    @property
    def last_clamp(self) -> Clamp | None:
        """The latest change of a command, or None if there was none. Any thread."""
        last = self._last_clamp
        if last is None:
            return None
        return Clamp(self.name, last[0], last[1], last[2])

    @abstractmethod
    def enforce_limits(self, period: float) -> None:
        """Replace the joint's command by the nearest admissible one.

        Args:
            period: Time since the last cycle [s], > 0.
        """

    def reset(self) -> None:
        """Forget the previous command; the next cycle starts from the joint's state."""

    def _count_clamp(self, asked: float, given: float, reason: ClampReason) -> None:
        # Readers in other threads exchange one reference, so they see whole tuples.
        self._last_clamp = (asked, given, reason)
        self.clamp_count += 1


class SoftLimitsHandle(JointLimitsHandle):
    """Enforce the limits of a joint that is slowed down before the limits.

    Args:
        joint: The joint's state and command, in the unit of the joint's command.
        limits: The joint's limits, read once.
        soft_limits: Range and gains; the range is ignored without position limits.

    Raises:
        JointLimitsError: A required limit is missing, or no command could satisfy the
            limits.
    """

    def __init__(
        self, joint: JointHandle, limits: JointLimits, soft_limits: SoftJointLimits
    ) -> None:
        super().__init__(joint, limits)
        soft_limits.validate(joint.name)
        self._soft_min: float = soft_limits.min_position
        self._soft_max: float = soft_limits.max_position
        self._k_position: float = soft_limits.k_position
        self._k_velocity: float = soft_limits.k_velocity


def _require_limit(joint: str, kind: str, value: float | None) -> None:
    if value is None:
        raise JointLimitsError(
            f"Cannot enforce limits for joint '{joint}'. "
            f"It has no {kind} limits specification.",
            remedy=f"Give joint '{joint}' a {kind} limit in the URDF (<limit "
            f'{kind}="...">) or as joint_limits/{joint}/max_{kind}.',
        )


def _or_else(limit: float | None, unlimited: float) -> float:
    return unlimited if limit is None else limit
