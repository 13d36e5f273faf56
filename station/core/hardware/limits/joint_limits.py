"""The hard and soft limits of a joint, read from parameters or a URDF.

Soft limits slow a joint down before its hard limits. Parameters have the form that
MoveIt also uses:

```yaml
joint_limits:
  elbow:
    has_position_limits: true
    min_position: -1.5
    max_position: 1.5
    has_velocity_limits: true
    max_velocity: 2.0
    has_soft_limits: true
    soft_lower_limit: -1.4
    soft_upper_limit: 1.4
    k_position: 10.0
    k_velocity: 20.0
```

`max_acceleration`, `max_jerk` and `max_effort` are written in the same way, each with
its `has_…_limits`. A value counts only if its flag is true. `angle_wraparound` counts
for a joint with `has_position_limits: false`.

Source: ros_control@633c374 joint_limits_rosparam.h, joint_limits_urdf.h. ROS
parameters are typed: a flag that is not true or false counts as absent, and so does a
value that is not a number.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from math import isfinite, isnan

from station.core.description.urdf import Joint, JointType
from station.core.errors import HardwareInterfaceError, show, suggest
from station.core.parameters import Parameters

_QUANTITIES = ("velocity", "acceleration", "jerk", "effort")
_VALUES = {
    "has_position_limits": ("min_position", "max_position"),
    **{f"has_{each}_limits": (f"max_{each}",) for each in _QUANTITIES},
}
"""The values that apply if a flag is true."""
_SOFT_KEYS = ("k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit")


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


def joint_limits_from_parameters(
    joint: str, params: Parameters, limits: JointLimits | None = None
) -> JointLimits | None:
    """Return a joint's limits from `joint_limits/<joint>`.

    A flag that is false removes the earlier limit. A flag that is true, with all its
    values, replaces it. Otherwise the earlier limit stays. Callers pass the limits of
    the URDF as the earlier ones, so that parameters win.

    Args:
        joint: Name of the joint.
        params: The namespace that holds `joint_limits`.
        limits: Earlier limits to be completed; None if there are none.

    Returns:
        The limits, or None if there is no entry for the joint.
    """
    if not params.has(f"joint_limits/{joint}"):
        return None
    entry = params.namespace(f"joint_limits/{joint}")
    result = _read_position_limits(entry, limits or JointLimits())
    return replace(
        result,
        max_velocity=_read_limit(entry, "velocity", result.max_velocity),
        max_acceleration=_read_limit(entry, "acceleration", result.max_acceleration),
        max_jerk=_read_limit(entry, "jerk", result.max_jerk),
        max_effort=_read_limit(entry, "effort", result.max_effort),
    )


def soft_joint_limits_from_parameters(
    joint: str, params: Parameters, soft_limits: SoftJointLimits | None = None
) -> SoftJointLimits | None:
    """Return a joint's soft limits from `joint_limits/<joint>`.

    Args:
        joint: Name of the joint.
        params: The namespace that holds `joint_limits`.
        soft_limits: Earlier soft limits; their values replace parameters that are not
            numbers.

    Returns:
        The soft limits, or None unless `has_soft_limits` is true and all four values
        are present.
    """
    entry = params.namespace(f"joint_limits/{joint}")
    # As in ros_control, values without their flag have no effect.
    if entry.get("has_soft_limits") is not True:
        return None
    if not all(entry.has(key) for key in _SOFT_KEYS):
        return None
    earlier = soft_limits or SoftJointLimits()
    return SoftJointLimits(
        min_position=_number_or(entry, "soft_lower_limit", earlier.min_position),
        max_position=_number_or(entry, "soft_upper_limit", earlier.max_position),
        k_position=_number_or(entry, "k_position", earlier.k_position),
        k_velocity=_number_or(entry, "k_velocity", earlier.k_velocity),
    )


def _read_position_limits(entry: Parameters, earlier: JointLimits) -> JointLimits:
    flag = entry.get("has_position_limits")
    if flag is True:
        low = _number(entry, "min_position")
        high = _number(entry, "max_position")
        # As in ros_control, a single bound is no range.
        if low is None or high is None:
            return earlier
        return replace(earlier, min_position=low, max_position=high)
    if flag is False:
        wraparound = entry.get("angle_wraparound")
        if not isinstance(wraparound, bool):
            wraparound = earlier.angle_wraparound
        return replace(
            earlier, min_position=None, max_position=None, angle_wraparound=wraparound
        )
    return earlier


def _read_limit(
    entry: Parameters, quantity: str, earlier: float | None
) -> float | None:
    flag = entry.get(f"has_{quantity}_limits")
    if flag is True:
        number = _number(entry, f"max_{quantity}")
        return earlier if number is None else number
    return None if flag is False else earlier


def _number(entry: Parameters, key: str) -> float | None:
    value = entry.get(key)
    # In Python, `true` counts as an integer.
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)


def _number_or(entry: Parameters, key: str, default: float) -> float:
    number = _number(entry, key)
    return default if number is None else number


def limits_without_effect(params: Parameters, joints: Collection[str]) -> list[str]:
    """Return a sentence about each entry of `joint_limits` that limits nothing.

    These are unknown joints and keys, values without their flag, and flags without
    their values. A value whose flag is false is left out on purpose.

    Args:
        params: The namespace that holds `joint_limits`.
        joints: The robot's joints.
    """
    limits = params.get("joint_limits")
    if not isinstance(limits, dict):
        return []
    found: list[str] = []
    for joint, entry in limits.items():
        place = f"joint_limits/{joint}"
        if joint not in joints:
            found.append(f"{place} names no joint. {suggest(str(joint), joints)}")
        elif not isinstance(entry, dict):
            found.append(f"{place} is {show(entry)}; it must be a mapping.")
        else:
            found += [f"{place}/{each}" for each in _without_effect(entry)]
    return found


def _without_effect(entry: dict[str, object]) -> list[str]:
    values = {**_VALUES, "has_soft_limits": _SOFT_KEYS}
    known = [*values, *(key for keys in values.values() for key in keys)]
    known.append("angle_wraparound")
    found = [
        f"{key} is unknown. {suggest(str(key), known)}"
        for key in entry
        if key not in known
    ]
    for flag, keys in values.items():
        given = entry.get(flag)
        if given is None:
            found += [
                f"{key} counts only with '{flag}: true'."
                for key in keys
                if key in entry
            ]
        elif not isinstance(given, bool):
            found.append(f"{flag} is {show(given)}; it must be true or false.")
        elif given:
            found += [
                f"{flag} is true and has no effect without a number for '{key}'."
                for key in keys
                if isinstance(entry.get(key), bool)
                or not isinstance(entry.get(key), int | float)
            ]
    return found


def joint_limits_from_urdf(
    joint: Joint, limits: JointLimits | None = None
) -> JointLimits | None:
    """Return a joint's limits from its `<limit>` element.

    The URDF replaces the earlier limits, but the jerk limit stays; the acceleration
    limit is removed.

    Args:
        joint: The joint of the robot description.
        limits: Earlier limits to be completed; None if there are none.

    Returns:
        The limits, or None if the joint has no `<limit>`.
    """
    if joint.limit is None:
        return None
    earlier = limits or JointLimits()
    return replace(
        earlier,
        min_position=joint.limit.lower,
        max_position=joint.limit.upper,
        max_velocity=joint.limit.velocity,
        max_acceleration=None,
        max_effort=joint.limit.effort,
        angle_wraparound=(
            earlier.angle_wraparound or joint.type is JointType.CONTINUOUS
        ),
    )


def soft_joint_limits_from_urdf(joint: Joint) -> SoftJointLimits | None:
    """Return a joint's soft limits from its `<safety_controller>` element.

    Args:
        joint: The joint of the robot description.

    Returns:
        The soft limits, or None if the joint has no `<safety_controller>`.
    """
    safety = joint.safety
    if safety is None:
        return None
    return SoftJointLimits(
        min_position=safety.soft_lower_limit,
        max_position=safety.soft_upper_limit,
        k_position=safety.k_position,
        k_velocity=safety.k_velocity,
    )
