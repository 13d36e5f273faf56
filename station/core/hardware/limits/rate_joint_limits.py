"""Limit position and velocity commands against the command of the last cycle.

These handles can be used instead of the saturation and soft limit handles. They limit
acceleration and jerk, too, and a joint outside its range is not pulled back, but may
only move towards the range. The rules are those of `velocity_profile`. Effort commands
have no rate to limit; `EffortJointSaturationHandle` serves them in this mode. Outside
the range it admits only an effort that points back.
"""

from typing_extensions import override

from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.limits.joint_limits import JointLimits
from station.core.hardware.limits.joint_limits_handle import JointLimitsHandle
from station.core.hardware.limits.joint_limits_interface import JointLimitsInterface
from station.core.hardware.limits.velocity_profile import VelocityProfile


class _RateLimitsHandle(JointLimitsHandle):
    """Hold the range and the velocity profile, which both kinds of command need."""

    def __init__(self, joint: JointHandle, limits: JointLimits) -> None:
        super().__init__(joint, limits)
        self._profile: VelocityProfile = VelocityProfile(limits)
        self._is_started: bool = False

    @override
    def reset(self) -> None:
        self._is_started = False

    def _note(self, asked: float, given: float) -> None:
        reason = self._profile.reason
        if reason is not None:
            self._count_clamp(asked, given, reason)


class PositionJointRateLimitsHandle(_RateLimitsHandle):
    """Limit the velocity, acceleration and jerk of position commands, and their range.

    The first command after construction or `reset` starts from the measured position
    and velocity. A period of 0 or less repeats the last command.
    """

    def __init__(self, joint: JointHandle, limits: JointLimits) -> None:
        """Read the limits once.

        Args:
            joint: The joint's state and position command [rad or m].
            limits: Limits, each of them optional.
        """
        super().__init__(joint, limits)
        self._previous: float = 0.0

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        asked = joint.get_command()
        # The manager refuses NaN; the profile starts afresh after one.
        if asked != asked:
            self._is_started = False
            return
        if not self._is_started:
            self._previous = joint.get_position()
            self._profile.start(joint.get_velocity())
            self._is_started = True
        previous = self._previous
        if period <= 0.0:
            joint.set_command(previous)
            return
        down = previous - self._min_position
        up = self._max_position - previous
        velocity = self._profile.limit((asked - previous) / period, down, up, period)
        given = asked
        if self._profile.reason is not None:
            given = previous + velocity * period
            if down >= 0.0 and given < self._min_position:
                given = self._min_position  # against rounding
            if up >= 0.0 and given > self._max_position:
                given = self._max_position  # against rounding
        joint.set_command(given)
        self._previous = given
        self._note(asked, given)


class VelocityJointRateLimitsHandle(_RateLimitsHandle):
    """Limit the acceleration and jerk of velocity commands, and the joint's range.

    The range is that of the measured position. The first command after construction
    or `reset` starts from the measured velocity. A period of 0 or less repeats the last
    command.
    """

    @override
    def enforce_limits(self, period: float) -> None:
        joint = self._joint
        asked = joint.get_command()
        # The manager refuses NaN; the profile starts afresh after one.
        if asked != asked:
            self._is_started = False
            return
        if not self._is_started:
            self._profile.start(joint.get_velocity())
            self._is_started = True
        if period <= 0.0:
            joint.set_command(self._profile.velocity)
            return
        position = joint.get_position()
        down = position - self._min_position
        up = self._max_position - position
        given = self._profile.limit(asked, down, up, period)
        joint.set_command(given)
        self._note(asked, given)


class PositionJointRateLimitsInterface(
    JointLimitsInterface[PositionJointRateLimitsHandle]
):
    """Limits of position-controlled joints against the command of the last cycle."""


class VelocityJointRateLimitsInterface(
    JointLimitsInterface[VelocityJointRateLimitsHandle]
):
    """Limits of velocity-controlled joints against the command of the last cycle."""
