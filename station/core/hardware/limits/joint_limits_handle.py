"""Enforce the limits of one joint, and count the commands that were changed."""

from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import ClassVar

from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.interfaces.resource_manager import ResourceHandle
from station.core.hardware.limits.joint_limits import (
    JointLimits,
    JointLimitsError,
    SoftJointLimits,
)
from station.core.hardware.limits.joint_limits_group import JointLimitsGroup
from station.core.hardware.limits.limited_joints import LimitedJoints


class ClampReason(Enum):
    """The limit that changed a command, in the order of the codes."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    JERK = "jerk"
    EFFORT = "effort"
    SOFT_POSITION = "soft_position"


_REASONS = tuple(ClampReason)


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


class JointLimitsHandle(ResourceHandle):
    """Enforce the limits of one joint once per cycle, after the controllers.

    Contract: `enforce_limits` is called by the control thread in `RobotHW.write`, with
    this cycle's state and command in the joint's slots; it allocates nothing unless it
    clamps. `reset` is called on a mode switch, an emergency stop or a recovery. The
    clamp figures may be read by any thread. A NaN command passes through unchanged and
    is not counted, as in the original: the robot and the manager refuse it.

    A kind of limits names its arithmetic, or overrides `enforce_limits`. Arithmetic of
    one kind runs for all joints of a `JointLimitsInterface` in one call.

    Args:
        joint: The joint's state and command, in the unit of the joint's command.
        limits: The joint's limits, read once.
        soft_limits: Range and gains of a kind that slows the joint down.

    Attributes:
        arithmetic: The compiled arithmetic; that of the base class limits nothing.
        required: The limits that the joint must have, such as "velocity".
        unlimited: What stands for a limit that the joint does not have.
        first_previous: The command of the last cycle in the first one; NaN if the
            measured state takes its place.
        is_grouped: Whether an interface enforces the limits together with others.
        clamp_count: Number of cycles in which the command was changed, since
            construction.

    Raises:
        JointLimitsError: A required limit is missing, or no command could satisfy the
            limits.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = LimitedJoints
    required: ClassVar[tuple[str, ...]] = ()
    unlimited: ClassVar[float] = nan
    first_previous: ClassVar[float] = nan

    def __init__(
        self,
        joint: JointHandle,
        limits: JointLimits,
        soft_limits: SoftJointLimits | None = None,
    ) -> None:
        super().__init__(joint.name)
        for kind in self.required:
            _require_limit(joint.name, kind, getattr(limits, f"max_{kind}"))
        limits.validate(joint.name)
        if soft_limits is not None:
            soft_limits.validate(joint.name)
        self.joint: JointHandle = joint
        self.bounds: dict[str, float] = self.find_bounds(limits, soft_limits)
        self.is_grouped: bool = False
        self.clamp_count: int = 0
        self._last_clamp: tuple[float, float, int] | None = None
        self._slot: int = 0
        self._group: JointLimitsGroup = JointLimitsGroup(
            self.arithmetic, [joint], [self.bounds], [self._first_memory()]
        )

    @property
    def last_clamp(self) -> Clamp | None:
        """The latest change of a command, or None if there was none. Any thread."""
        last = self._last_clamp
        if last is None:
            return None
        return Clamp(self.name, last[0], last[1], _REASONS[last[2]])

    def find_bounds(
        self, limits: JointLimits, soft_limits: SoftJointLimits | None
    ) -> dict[str, float]:
        """Return the limits as the arithmetic wants them, by `joint_limits.LIMITS`.

        Args:
            limits: The joint's limits.
            soft_limits: The soft limits; their range counts for a joint that has one.
        """
        soft = SoftJointLimits() if soft_limits is None else soft_limits
        has_range = limits.has_position_limits
        found = {
            "min_position": limits.min_position,
            "max_position": limits.max_position,
            "max_velocity": limits.max_velocity,
            "max_acceleration": limits.max_acceleration,
            "max_jerk": limits.max_jerk,
            "max_effort": limits.max_effort,
            # A continuous joint has no range that a soft limit could be inside of.
            "soft_min": soft.min_position if has_range else None,
            "soft_max": soft.max_position if has_range else None,
            "k_position": soft.k_position,
            "k_velocity": soft.k_velocity,
        }
        absent = self.unlimited
        bounds = {name: absent if x is None else x for name, x in found.items()}
        # No lower limit must be below everything, where `unlimited` is infinite.
        if limits.min_position is None:
            bounds["min_position"] = -absent
        return bounds

    def enforce_limits(self, period: float) -> None:
        """Replace the joint's command by the nearest admissible one.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        slot = self._slot
        if self._group.enforce(period, slot, slot + 1):
            self.count_clamp()

    def reset(self) -> None:
        """Forget the previous command; the next cycle starts from the joint's state."""
        self._group.remember(self._slot, self._first_memory())

    @property
    def enforces_alone(self) -> bool:
        """Return whether the handle's class has a way of its own to enforce limits."""
        # A subclass that enforces in its own way must get its calls; a group would pass
        # it over.
        return type(self).enforce_limits is not JointLimitsHandle.enforce_limits

    def memory(self) -> dict[str, float]:
        """Return the state remembered from the last cycle. For interfaces."""
        return self._group.memory(self._slot)

    def join(self, group: JointLimitsGroup, slot: int) -> None:
        """Use the memory of a group from now on. For interfaces.

        Args:
            group: A group that has begun with `bounds` and `memory()`.
            slot: The joint's place in it.
        """
        self._group, self._slot = group, slot
        self.is_grouped = True

    def count_clamp(self) -> None:
        """Count the change that the group has just made. Control thread."""
        # Readers in other threads exchange one reference, so they see whole tuples.
        self._last_clamp = self._group.clamp(self._slot)
        self.clamp_count += 1

    def _first_memory(self) -> dict[str, float]:
        return {
            "previous": self.first_previous,
            "velocity_before": nan,
            "acceleration_before": 0.0,
        }


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
        super().__init__(joint, limits, soft_limits)


def _require_limit(joint: str, kind: str, value: float | None) -> None:
    if value is None:
        raise JointLimitsError(
            f"Cannot enforce limits for joint '{joint}'. "
            f"It has no {kind} limits specification.",
            remedy=f"Give joint '{joint}' a {kind} limit in the URDF (<limit "
            f'{kind}="...">) or as joint_limits/{joint}/max_{kind}.',
        )
