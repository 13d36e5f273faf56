"""Read joint limits from a robot description.

Source: ros_control@633c374 joint_limits_urdf.h; urdfdom@3.0.1 joint.cpp for what a
`<limit>` and a `<safety_controller>` must have; differs: what makes urdfdom discard the
whole description is raised here, with joint, element and reason.
"""

from dataclasses import replace
from typing import NoReturn
from xml.etree import ElementTree as ET

from station.core.description.urdf_text import parse_decimal
from station.core.errors import RobotDescriptionError
from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits

_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_LIMITED = ("revolute", "prismatic")


def joint_limits_from_urdf(
    joint: ET.Element, limits: JointLimits | None = None
) -> JointLimits | None:
    """Return a joint's limits from its `<limit>` element.

    `effort` and `velocity` are required there, `lower` and `upper` are 0 if absent and
    count for revolute and prismatic joints alone. The URDF wins over earlier limits; it
    removes those of acceleration, and keeps those of jerk.

    Args:
        joint: The `<joint>` element of a URDF.
        limits: Earlier limits to be completed; none when absent.

    Returns:
        The limits, or None if the joint has no `<limit>`.

    Raises:
        RobotDescriptionError: The joint's type is unknown, it is revolute or prismatic
            and has no `<limit>`, or a number is missing or wrong.
    """
    kind = joint.get("type", "")
    if kind not in _TYPES:
        _refuse(joint, f"has the type '{kind}'; allowed are {', '.join(_TYPES)}")
    element = joint.find("limit")
    if element is None:
        if kind in _LIMITED:
            _refuse(joint, f"is {kind} and has no <limit>")
        return None
    lower = _read_number(joint, element, "lower", default=0.0)
    upper = _read_number(joint, element, "upper", default=0.0)
    effort = _read_number(joint, element, "effort")
    velocity = _read_number(joint, element, "velocity")
    earlier = limits or JointLimits()
    return replace(
        earlier,
        min_position=lower if kind in _LIMITED else None,
        max_position=upper if kind in _LIMITED else None,
        max_velocity=velocity,
        max_acceleration=None,
        max_effort=effort,
        angle_wraparound=earlier.angle_wraparound or kind == "continuous",
    )


def soft_joint_limits_from_urdf(joint: ET.Element) -> SoftJointLimits | None:
    """Return a joint's soft limits from its `<safety_controller>` element.

    `k_velocity` is required there; all else is 0 if absent.

    Args:
        joint: The `<joint>` element of a URDF.

    Returns:
        The soft limits, or None if the joint has no `<safety_controller>`.

    Raises:
        RobotDescriptionError: A number is missing or wrong.
    """
    element = joint.find("safety_controller")
    if element is None:
        return None
    return SoftJointLimits(
        min_position=_read_number(joint, element, "soft_lower_limit", default=0.0),
        max_position=_read_number(joint, element, "soft_upper_limit", default=0.0),
        k_position=_read_number(joint, element, "k_position", default=0.0),
        k_velocity=_read_number(joint, element, "k_velocity"),
    )


def _read_number(
    joint: ET.Element, element: ET.Element, name: str, default: float | None = None
) -> float:
    text = element.get(name)
    if text is None:
        if default is None:
            _refuse(joint, f"has a <{element.tag}> without {name}")
        return default
    number = parse_decimal(text)
    if number is None:
        _refuse(joint, f'has a <{element.tag}> with {name}="{text}", not a number')
    return number


def _refuse(joint: ET.Element, problem: str) -> NoReturn:
    name = joint.get("name", "")
    raise RobotDescriptionError(
        f"Joint '{name}' {problem}.",
        remedy=f'Correct the <joint name="{name}"> element of the URDF.',
        details={"joint": name},
    )
