"""Read the pose of one arm's base in the frame of another arm's base.

Both bases are links of one robot description, and fixed joints connect them.
"""

from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf_text import parse_decimal, parse_robot_description
from station.core.errors import RobotDescriptionError


def base_transform(xml: str, link: str, other: str) -> NDArray[np.float64]:
    """Return the pose of the link `other` in the frame of `link`, shape (4, 4).

    Args:
        xml: The URDF.
        link: The link in whose frame the pose is given.
        other: The link whose pose is returned.

    Raises:
        RobotDescriptionError: A link is missing, or the links can move against each
            other.
    """
    root = parse_robot_description(xml)
    first, root_of_first = _pose_in_root(root, link)
    second, root_of_second = _pose_in_root(root, other)
    if root_of_first != root_of_second:
        raise RobotDescriptionError(
            f"Links '{link}' and '{other}' are not fixed to the same link: the first "
            f"is fixed to '{root_of_first}', the second to '{root_of_second}'.",
            remedy="Connect them by fixed joints in the robot description.",
            details={"links": [link, other]},
        )
    result: NDArray[np.float64] = np.linalg.inv(first) @ second
    return result


def _pose_in_root(root: ET.Element, link: str) -> tuple[NDArray[np.float64], str]:
    """Return the pose of a link in the farthest link that fixed joints lead to.

    Raises:
        RobotDescriptionError: The link is missing.
    """
    if not any(element.get("name") == link for element in root.findall("link")):
        raise RobotDescriptionError(
            f"The robot description has no link '{link}'.",
            remedy="Name links of the description, or describe all arms in it.",
            details={"link": link},
        )
    parents = {_link(joint, "child"): joint for joint in root.findall("joint")}
    pose = np.eye(4)
    while (joint := parents.pop(link, None)) is not None:
        if joint.get("type") != "fixed":
            break
        pose = _origin(joint) @ pose
        link = _link(joint, "parent")
    return pose, link


def _link(joint: ET.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _origin(joint: ET.Element) -> NDArray[np.float64]:
    element = joint.find("origin")
    pose = np.eye(4)
    if element is None:
        return pose
    pose[:3, 3] = _numbers(joint, element, "xyz")
    roll, pitch, yaw = _numbers(joint, element, "rpy")
    for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
        pose[:3, :3] = pose[:3, :3] @ _turn(axis, angle)
    return pose


def _turn(axis: int, angle: float) -> NDArray[np.float64]:
    matrix = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -np.sin(angle)
    return matrix


def _numbers(joint: ET.Element, element: ET.Element, name: str) -> list[float]:
    text = element.get(name, "0 0 0")
    numbers = [
        number for part in text.split() if (number := parse_decimal(part)) is not None
    ]
    if len(numbers) != 3 or len(text.split()) != 3:
        raise RobotDescriptionError(
            f"Joint '{joint.get('name', '')}' has an <origin> with {name}=\"{text}\"; "
            "it must be three numbers.",
            remedy="Correct the robot description.",
            details={"joint": joint.get("name", "")},
        )
    return numbers
