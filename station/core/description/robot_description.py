"""The robot's URDF as controllers ask for it: joints one by one, and chains to frames.

A joint is read only when a controller asks for it, so that a document may lack elements
that no controller needs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf
from typing import NoReturn
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Joint, JointLimit, JointType, Pose, Urdf
from station.core.description.urdf_parser import (
    read_joint_limit,
    read_joint_type,
    read_safety_controller,
)
from station.core.description.urdf_text import parse_robot
from station.core.errors import ControllerLoadError, RobotDescriptionError
from station.core.numerics.arm_chain import JointChain
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
            return _read(found)
    return None


# Cached, because every controller of a robot asks for the same document.
@lru_cache(maxsize=8)
def _read(xml: str) -> RobotDescription:
    return RobotDescription(xml)


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


def chain_to(urdf: Urdf, base: str, frame: str, joints: Sequence[str]) -> JointChain:
    """Return the chain from one link to another.

    Args:
        urdf: The robot.
        base: Link at which the chain begins; `frame` is below this link, or below a
            link that carries this link by fixed joints only.
        frame: Link at the end of the chain.
        joints: The joints whose positions the caller gives, in their order.

    Raises:
        ControllerLoadError: A link is unknown, no chain leads from one link to the
            other, or a joint in it is not among `joints`.
    """
    for link in (base, frame):
        if link not in urdf.links:
            _refuse(f"The robot has no link '{link}'.")
    # The links that carry the base by fixed joints, and the pose of each in the base.
    carriers, pose, link = {base: np.eye(4)}, np.eye(4), base
    while (above := urdf.joint_above(link)) and above.type is JointType.FIXED:
        pose = pose @ np.linalg.inv(_matrix(above.origin))
        link = above.parent
        carriers[link] = pose
    path: list[Joint] = []
    link = frame
    while link not in carriers:
        above = urdf.joint_above(link)
        if above is None:
            _refuse(f"Link '{frame}' is not below '{base}'.")
        path.insert(0, above)
        link = above.parent
    origins = [carriers[link]]
    moving: list[Joint] = []
    for joint in path:
        origins[-1] = origins[-1] @ _matrix(joint.origin)
        if joint.type is JointType.FIXED:
            continue
        if joint.name not in joints:
            _refuse(
                f"Joint '{joint.name}' between '{base}' and '{frame}' is none of the "
                "controller's."
            )
        moving.append(joint)
        origins.append(np.eye(4))
    return JointChain(
        len(joints),
        np.concatenate([origin.T.ravel() for origin in origins]).tolist(),
        [part for joint in moving for part in joint.axis],
        [float(joint.type.is_rotation) for joint in moving],
        [joints.index(joint.name) for joint in moving],
    )


def ends_of_chain(urdf: Urdf, joints: Sequence[str]) -> tuple[str, str]:
    """Return the links at both ends of a chain of joints: its base and its tip.

    The tip is the last link that is fixed below the last joint. If there are several,
    it is the link that is called `tool0`, as in ROS-Industrial.

    Args:
        urdf: The robot.
        joints: The joints, in any order.

    Raises:
        ControllerLoadError: The joints form no chain, or several links could be
            the tip.
    """
    moved = [urdf.joints[name] for name in joints if name in urdf.joints]
    carried = {joint.name: _joints_above(urdf, joint) for joint in moved}
    last = max(carried, key=lambda name: len(carried[name]), default="")
    chain = [joint for joint in carried.get(last, ()) if joint.name in joints]
    if len(chain) < len(joints):
        _refuse("The joints of the controller form no chain.")
    ends, waiting = [], [chain[0].child]
    while waiting:
        link = waiting.pop()
        fixed = [j for j in urdf.joints_below(link) if j.type is JointType.FIXED]
        waiting += [joint.child for joint in fixed]
        ends += [] if fixed else [link]
    tips = [link for link in ends if link.endswith("tool0")] or ends
    if len(tips) > 1:
        _refuse(f"The tip of the arm may be {' or '.join(sorted(tips))}.")
    return chain[-1].parent, tips[0]


def _joints_above(urdf: Urdf, joint: Joint) -> list[Joint]:
    """Return a joint and all joints that carry it, towards the root."""
    found = [joint]
    while (above := urdf.joint_above(found[-1].parent)) is not None:
        found.append(above)
    return found


def _refuse(problem: str) -> NoReturn:
    raise ControllerLoadError(
        problem, remedy="Correct `kinematics`, `joints` or the name of the frame."
    )


def _matrix(pose: Pose) -> NDArray[np.float64]:
    """Return a pose as a matrix, shape (4, 4)."""
    w, x, y, z = pose.quaternion
    result = np.eye(4)
    result[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    result[:3, 3] = pose.xyz
    return result
