"""Read a joint's type, limits and soft limits from its `<joint>` element.

Source: urdfdom@3.0.1 joint.cpp for what a `<limit>` and a `<safety_controller>` must
have; differs: what makes urdfdom discard the whole description is raised here, with
joint, element and reason.
"""

from typing import NoReturn
from xml.etree import ElementTree as ET

from station.core.description.urdf import JointLimit, JointType, SafetyController
from station.core.description.urdf_text import parse_decimal
from station.core.errors import RobotDescriptionError


def read_joint_type(joint: ET.Element) -> JointType:
    """Return the type of a joint.

    Args:
        joint: The `<joint>` element of a URDF.

    Raises:
        RobotDescriptionError: The element has no type or an unknown one.
    """
    kind = joint.get("type", "")
    try:
        return JointType(kind)
    except ValueError:
        allowed = ", ".join(known.value for known in JointType)
        _refuse(joint, f"has the type '{kind}'; allowed are {allowed}")


def read_joint_limit(joint: ET.Element) -> JointLimit | None:
    """Return the numbers of a joint's `<limit>` element.

    `effort` and `velocity` are required there; `lower` and `upper` are 0 if absent, and
    count for revolute and prismatic joints alone.

    Args:
        joint: The `<joint>` element of a URDF.

    Returns:
        The limits, or None if the joint has no `<limit>`.

    Raises:
        RobotDescriptionError: The joint's type is unknown, it is revolute or prismatic
            and has no `<limit>`, or a number is missing or wrong.
    """
    kind = read_joint_type(joint)
    element = joint.find("limit")
    if element is None:
        if kind.has_position_limits:
            _refuse(joint, f"is {kind.value} and has no <limit>")
        return None
    lower = _read_number(joint, element, "lower", default=0.0)
    upper = _read_number(joint, element, "upper", default=0.0)
    return JointLimit(
        effort=_read_number(joint, element, "effort"),
        velocity=_read_number(joint, element, "velocity"),
        lower=lower if kind.has_position_limits else None,
        upper=upper if kind.has_position_limits else None,
    )


def read_safety_controller(joint: ET.Element) -> SafetyController | None:
    """Return the numbers of a joint's `<safety_controller>` element.

    `k_velocity` is required there; every other number is 0 if absent.

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
    return SafetyController(
        soft_lower_limit=_read_number(joint, element, "soft_lower_limit", default=0.0),
        soft_upper_limit=_read_number(joint, element, "soft_upper_limit", default=0.0),
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
