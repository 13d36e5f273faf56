"""What a controller needs to know about a joint from the robot's URDF.

Types and limits are read as `station.core.hardware.limits.urdf` reads them.
"""

from dataclasses import dataclass
from enum import Enum
from math import inf
from xml.etree import ElementTree

from station.core.description.urdf_text import parse_robot_description
from station.core.errors import RobotDescriptionError
from station.core.hardware.limits import (
    JointLimits,
    JointLimitsError,
    joint_limits_from_urdf,
    soft_joint_limits_from_urdf,
)
from station.core.parameters import Parameters

ROBOT_DESCRIPTION = "robot_description"
"""Name of the parameter that holds the URDF as a string."""


class JointType(Enum):
    """How a joint moves."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    FLOATING = "floating"
    PLANAR = "planar"


@dataclass(frozen=True, slots=True)
class JointDescription:
    """Type and limits of one joint.

    Attributes:
        name: Its name.
        type: How it moves.
        lower: Lowest position [rad or m]; -inf where unlimited.
        upper: Highest position [rad or m]; inf where unlimited.
        velocity: Highest speed [rad/s or m/s], > 0; inf where unlimited.
        effort: Highest effort [Nm or N], > 0; inf where unlimited.
    """

    name: str
    type: JointType = JointType.CONTINUOUS
    lower: float = float("-inf")
    upper: float = float("inf")
    velocity: float = float("inf")
    effort: float = float("inf")

    def is_linear(self) -> bool:
        """Say whether the joint moves along a line."""
        return self.type is JointType.PRISMATIC

    def is_limited(self) -> bool:
        """Say whether the joint's position has limits."""
        return self.type is JointType.REVOLUTE or self.type is JointType.PRISMATIC


class RobotDescription:
    """The joints of a URDF.

    Args:
        xml: The URDF document.

    Raises:
        RobotDescriptionError: `xml` is not a URDF document.
    """

    def __init__(self, xml: str) -> None:
        root = parse_robot_description(xml)
        if root.tag != "robot":
            raise RobotDescriptionError(
                f"The robot description is a <{root.tag}> document.",
                remedy="Give a URDF; its root element is <robot>.",
            )
        self._joints = {
            element.get("name", ""): element for element in root.findall("joint")
        }

    def joint_names(self) -> list[str]:
        """Return the names of all joints in the order of the document."""
        return list(self._joints)

    def joint(self, name: str) -> JointDescription:
        """Return type and limits of the joint `name`.

        Raises:
            RobotDescriptionError: There is no such joint, or its type or limits are
                missing or impossible.
        """
        return _joint_description(name, self._find(name))

    def soft_limits(self, name: str) -> tuple[float, float]:
        """Return the soft limits of the joint `name`, lower and upper [rad or m].

        Raises:
            RobotDescriptionError: There is no such joint, it has no soft limits, or a
                number of them is wrong.
        """
        soft = soft_joint_limits_from_urdf(self._find(name))
        if soft is None:
            raise RobotDescriptionError(
                f"Joint '{name}' has no <safety_controller> in the robot description.",
                remedy="Give it one with soft_lower_limit and soft_upper_limit.",
                details={"resource": name},
            )
        return soft.min_position, soft.max_position

    def _find(self, name: str) -> ElementTree.Element:
        element = self._joints.get(name)
        if element is None:
            raise RobotDescriptionError(
                f"The robot description has no joint '{name}'.",
                remedy=f"It has: {', '.join(self._joints) or 'none'}.",
                details={"resource": name},
            )
        return element


def find_robot_description(params: Parameters) -> RobotDescription | None:
    """Return the description in the nearest namespace around `params`.

    Looked for in the namespace itself, then outwards up to the root.

    Args:
        params: Where to begin, usually a controller's namespace.

    Returns:
        The description, None when no namespace has one.

    Raises:
        RobotDescriptionError: What is there is no URDF.
    """
    parts = params.path.split("/") if params.path else []
    for count in range(len(parts), -1, -1):
        where = "/".join([*parts[:count], ROBOT_DESCRIPTION])
        found = params.tree.get(where)
        if isinstance(found, str):
            return RobotDescription(found)
    return None


def require_robot_description(params: Parameters) -> RobotDescription:
    """Return the description around `params`.

    Args:
        params: Where to begin, usually a controller's namespace.

    Raises:
        RobotDescriptionError: There is none, or it is no URDF.
    """
    description = find_robot_description(params)
    if description is None:
        raise RobotDescriptionError(
            f"Parameter '{ROBOT_DESCRIPTION}' is missing; the controller in "
            f"'{params.path}' reads joint types and limits from it.",
            remedy=f"Store the robot's URDF as '{ROBOT_DESCRIPTION}' in the root.",
            details={"parameter": ROBOT_DESCRIPTION},
        )
    return description


def _joint_description(name: str, element: ElementTree.Element) -> JointDescription:
    limits = joint_limits_from_urdf(element) or JointLimits()
    try:
        limits.validate(name)
    except JointLimitsError as error:
        raise RobotDescriptionError(
            error.message, remedy=error.remedy, details={"resource": name}
        ) from error
    low, high = limits.min_position, limits.max_position
    return JointDescription(
        name,
        JointType(element.get("type")),
        lower=-inf if low is None else low,
        upper=inf if high is None else high,
        # 0 in a URDF stands for a joint nobody limited.
        velocity=limits.max_velocity or inf,
        effort=limits.max_effort or inf,
    )
