"""What a controller needs to know about a joint from the robot's URDF.

Source: urdfdom@3.0.0 urdf_parser/src/joint.cpp; only type and limits are read.
"""

from dataclasses import dataclass
from enum import Enum
from math import isfinite
from xml.etree import ElementTree

from station.core.errors import RobotDescriptionError
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
        try:
            root = ElementTree.fromstring(xml)
        except ElementTree.ParseError as error:
            raise RobotDescriptionError(
                f"The robot description is not XML: {error}.",
                remedy=f"Put the URDF document itself into '{ROBOT_DESCRIPTION}'.",
            ) from error
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
        element = self._joints.get(name)
        if element is None:
            raise RobotDescriptionError(
                f"The robot description has no joint '{name}'.",
                remedy=f"It has: {', '.join(self._joints) or 'none'}.",
                details={"resource": name},
            )
        return _joint_description(name, element)


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
    kind = element.get("type", "")
    try:
        joint_type = JointType(kind)
    except ValueError as error:
        raise RobotDescriptionError(
            f"Joint '{name}' has the type '{kind}'.",
            remedy=f"Allowed are {', '.join(t.value for t in JointType)}.",
            details={"resource": name},
        ) from error
    limit = element.find("limit")
    if limit is None:
        if joint_type in {JointType.REVOLUTE, JointType.PRISMATIC}:
            raise RobotDescriptionError(
                f"Joint '{name}' is {kind} and has no <limit>.",
                remedy="Add <limit lower= upper= effort= velocity=>.",
                details={"resource": name},
            )
        return JointDescription(name, joint_type)
    velocity = _bound(name, limit, "velocity")
    effort = _bound(name, limit, "effort")
    if joint_type not in {JointType.REVOLUTE, JointType.PRISMATIC}:
        return JointDescription(name, joint_type, velocity=velocity, effort=effort)
    lower = _number(name, limit, "lower", 0.0)
    upper = _number(name, limit, "upper", 0.0)
    if lower > upper:
        raise RobotDescriptionError(
            f"Joint '{name}' has the lower limit {lower} above the upper one {upper}.",
            remedy="Correct the <limit> of the joint.",
            details={"resource": name},
        )
    return JointDescription(name, joint_type, lower, upper, velocity, effort)


def _bound(name: str, limit: ElementTree.Element, key: str) -> float:
    """Return a speed or an effort; 0 in a URDF stands for a joint nobody limited.

    Raises:
        RobotDescriptionError: It is negative or no finite number.
    """
    value = _number(name, limit, key, 0.0)
    if value < 0.0:
        raise RobotDescriptionError(
            f"Joint '{name}' has the {key} limit {value}.",
            remedy="Give a positive number, or 0 for no limit.",
            details={"resource": name},
        )
    return value if value > 0.0 else float("inf")


def _number(name: str, limit: ElementTree.Element, key: str, default: float) -> float:
    text = limit.get(key)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise RobotDescriptionError(
            f"Joint '{name}' has the {key} limit '{text}'.",
            remedy="Give a finite number.",
            details={"resource": name},
        )
    return value
