"""Enforce the limits of one joint, and count the commands that were changed."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum

from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.interfaces.resource_manager import ResourceHandle
from station.core.hardware.limits.joint_limits import JointLimitsError


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

    Attributes:
        clamp_count: Number of cycles in which the command was changed, since
            construction.
    """

    def __init__(self, joint: JointHandle) -> None:
        super().__init__(joint.name)
        self._joint: JointHandle = joint
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


def require_limit(joint: str, kind: str, value: float | None) -> float:
    """Return a limit that a handle needs.

    Args:
        joint: Name of the joint, for the message.
        kind: Name of the limit in the message, such as "velocity".
        value: The limit, or None if the joint has none.

    Returns:
        The limit itself.

    Raises:
        JointLimitsError: The joint has no such limit.
    """
    if value is None:
        raise JointLimitsError(
            f"Cannot enforce limits for joint '{joint}'. "
            f"It has no {kind} limits specification.",
            remedy=f"Give joint '{joint}' a {kind} limit in the URDF (<limit "
            f'{kind}="...">) or as joint_limits/{joint}/max_{kind}.',
        )
    return value
