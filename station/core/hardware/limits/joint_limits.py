"""The hard limits of a joint, and the soft limits that slow it down before them."""

from dataclasses import dataclass
from math import isfinite, isnan

from station.core.errors import HardwareInterfaceError


class JointLimitsError(HardwareInterfaceError, ValueError):
    """A joint's limits are missing, contradict each other or are not numbers.

    Source:
        ros_control@633c374 joint_limits_interface_exception.h,
        JointLimitsInterfaceException; differs: the message also has a remedy.
    """

    code = "joint_limits"


@dataclass(frozen=True, slots=True)
class JointLimits:
    """The hard limits of one joint; `None` means that there is no such limit.

    Attributes:
        min_position: Lower bound [rad or m]; absent together with `max_position`.
        max_position: Upper bound [rad or m]; absent together with `min_position`.
        max_velocity: Bound of the speed in both directions, >= 0 [rad/s or m/s].
        max_acceleration: Bound in both directions, >= 0 [rad/s^2 or m/s^2].
        max_jerk: Bound in both directions, >= 0 [rad/s^3 or m/s^3].
        max_effort: Bound in both directions, >= 0 [N*m or N].
        angle_wraparound: True for a joint that may turn without end.

    Source:
        ros_control@633c374 joint_limits.h, JointLimits; differs: `None` instead of a
        `has_x` flag beside each number.
    """

    min_position: float | None = None
    max_position: float | None = None
    max_velocity: float | None = None
    max_acceleration: float | None = None
    max_jerk: float | None = None
    max_effort: float | None = None
    angle_wraparound: bool = False

    @property
    def has_position_limits(self) -> bool:
        """Return whether both position bounds are given."""
        return self.min_position is not None and self.max_position is not None

    def validate(self, joint: str) -> None:
        """Refuse limits that no command could satisfy.

        The readers of limits return the numbers of a file unchecked, as the original
        does. A robot validates limits before it enforces them, and every limit handle
        does so when it is built.

        Args:
            joint: Name of the joint, for the message.

        Raises:
            JointLimitsError: A position bound is missing, the bounds are inverted, a
                magnitude is negative, or a value is not a number.
        """
        if (self.min_position is None) != (self.max_position is None):
            raise JointLimitsError(
                f"Joint '{joint}' has only one position bound: min_position is "
                f"{self.min_position} and max_position is {self.max_position}.",
                remedy="Give both bounds, or neither for a continuous joint.",
            )
        if self.min_position is not None and self.max_position is not None:
            _validate_range(joint, "position", self.min_position, self.max_position)
        for name, magnitude in (
            ("velocity", self.max_velocity),
            ("acceleration", self.max_acceleration),
            ("jerk", self.max_jerk),
            ("effort", self.max_effort),
        ):
            if magnitude is not None and not magnitude >= 0.0:
                raise JointLimitsError(
                    f"Joint '{joint}' has a {name} limit of {magnitude}; "
                    "allowed are numbers >= 0.",
                    remedy=f"Correct the {name} limit, or leave it out.",
                )


@dataclass(frozen=True, slots=True)
class SoftJointLimits:
    """The range beyond which a joint is slowed down before its hard limits.

    Attributes:
        min_position: Lower bound [rad or m].
        max_position: Upper bound [rad or m].
        k_position: Velocity bound per distance to the soft bound, >= 0 [1/s].
        k_velocity: Effort bound per excess of velocity, >= 0 [N*m*s/rad or N*s/m].

    Source:
        ros_control@633c374 joint_limits.h, SoftJointLimits.
    """

    min_position: float = 0.0
    max_position: float = 0.0
    k_position: float = 0.0
    k_velocity: float = 0.0

    def validate(self, joint: str) -> None:
        """Refuse soft limits that no command could satisfy.

        Args:
            joint: Name of the joint, for the message.

        Raises:
            JointLimitsError: The bounds are inverted, a gain is negative or not finite,
                or a value is not a number.
        """
        _validate_range(joint, "soft position", self.min_position, self.max_position)
        for name, gain in (
            ("k_position", self.k_position),
            ("k_velocity", self.k_velocity),
        ):
            if not (isfinite(gain) and gain >= 0.0):
                raise JointLimitsError(
                    f"Joint '{joint}' has soft limits with {name}={gain}; "
                    "allowed are finite numbers >= 0.",
                    remedy=f"Correct {name} of the soft limits.",
                )


def _validate_range(joint: str, kind: str, low: float, high: float) -> None:
    if isnan(low) or isnan(high) or low > high:
        raise JointLimitsError(
            f"Joint '{joint}' has {kind} limits from {low} to {high}; "
            "the lower bound must not exceed the upper one.",
            remedy=f"Swap or correct the {kind} limits of '{joint}'.",
        )
