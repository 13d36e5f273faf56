"""The joints of the robot's URDF, one by one, as controllers ask for them.

A joint is read only when a controller asks for it, so that a document may lack elements
that no controller needs.
"""

from dataclasses import dataclass
from math import inf
from xml.etree import ElementTree

from station.core.description.urdf import JointLimit, JointType
from station.core.description.urdf_parser import (
    read_joint_limit,
    read_joint_type,
    read_safety_controller,
)
from station.core.description.urdf_text import parse_robot
from station.core.errors import RobotDescriptionError
from station.core.parameters import Parameters

ROBOT_DESCRIPTION = "robot_description"
"""Name of the parameter that holds the URDF as a string."""


@dataclass(frozen=True, slots=True)
class JointDescription:
    """Type and limits of one joint.

    Attributes:
        name: The joint's name.
        type: Type of the joint.
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
        """Return whether the joint moves along a line."""
        return self.type is JointType.PRISMATIC


class RobotDescription:
    """The joints of a URDF.

    Args:
        xml: The URDF document.

    Attributes:
        xml: As given.

    Raises:
        RobotDescriptionError: `xml` is not a URDF document.
    """

    def __init__(self, xml: str) -> None:
        self.xml = xml
        robot = parse_robot(xml)
        self._joints = {
            element.get("name", ""): element for element in robot.findall("joint")
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
        element = self._find(name)
        kind, limit = read_joint_type(element), read_joint_limit(element)
        if limit is None:
            return JointDescription(name, kind)
        _check_limit(name, limit)
        return JointDescription(
            name,
            kind,
            lower=-inf if limit.lower is None else limit.lower,
            upper=inf if limit.upper is None else limit.upper,
            # A limit of 0 in a URDF means that the velocity is not limited.
            velocity=limit.velocity or inf,
            effort=limit.effort or inf,
        )

    def soft_limits(self, name: str) -> tuple[float, float]:
        """Return the soft limits of the joint `name`, lower and upper [rad or m].

        Raises:
            RobotDescriptionError: There is no such joint, it has no soft limits, or a
                number in them is wrong.
        """
        soft = read_safety_controller(self._find(name))
        if soft is None:
            raise RobotDescriptionError(
                f"Joint '{name}' has no <safety_controller> in the robot description.",
                remedy="Give it one with soft_lower_limit and soft_upper_limit.",
                details={"resource": name},
            )
        return soft.soft_lower_limit, soft.soft_upper_limit

    def _find(self, name: str) -> ElementTree.Element:
        # A reference of a controller, `controller/joint`, is described as its joint.
        element = self._joints.get(name, self._joints.get(name.rpartition("/")[2]))
        if element is None:
            raise RobotDescriptionError(
                f"The robot description has no joint '{name}'.",
                remedy=f"It has: {', '.join(self._joints) or 'none'}.",
                details={"resource": name},
            )
        return element


def find_robot_description(params: Parameters) -> RobotDescription | None:
    """Return the description in the nearest namespace around `params`.

    The search begins in the namespace itself and goes outwards up to the root.

    Args:
        params: First namespace of the search, usually a controller's.

    Returns:
        The description, or None if no namespace has one.

    Raises:
        RobotDescriptionError: The parameter that was found is not a URDF.
    """
    parts = params.path.split("/") if params.path else []
    for count in range(len(parts), -1, -1):
        where = "/".join([*parts[:count], ROBOT_DESCRIPTION])
        found = params.tree.get(where)
        if isinstance(found, str):
            return RobotDescription(found)
    return None


def require_robot_description(params: Parameters) -> RobotDescription:
    """Return the description in the nearest namespace around `params`.

    Args:
        params: First namespace of the search, usually a controller's.

    Raises:
        RobotDescriptionError: No namespace has a description, or the parameter that was
            found is not a URDF.
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


def _check_limit(joint: str, limit: JointLimit) -> None:
    if (
        limit.lower is not None
        and limit.upper is not None
        and limit.lower > limit.upper
    ):
        raise RobotDescriptionError(
            f"Joint '{joint}' has position limits from {limit.lower} to {limit.upper}; "
            "the lower bound must not exceed the upper one.",
            remedy=f"Swap or correct the position limits of '{joint}'.",
            details={"resource": joint},
        )
    for name, magnitude in (("velocity", limit.velocity), ("effort", limit.effort)):
        if magnitude < 0.0:
            raise RobotDescriptionError(
                f"Joint '{joint}' has a {name} limit of {magnitude}; allowed are "
                "numbers >= 0.",
                remedy=f"Correct the {name} limit of '{joint}'.",
                details={"resource": joint},
            )
