"""Read a URDF into the model of a robot.

Every refusal names the file, the element and the reason.
"""

import math
from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType
from typing import NoReturn, TypeVar
from xml.etree.ElementTree import Element

from station.core.description.urdf import (
    Inertial,
    Joint,
    JointLimit,
    JointType,
    Link,
    Mimic,
    Pose,
    SafetyController,
    Shape,
    Urdf,
    Vector3,
)
from station.core.description.urdf_text import parse_decimal, parse_robot
from station.core.errors import RobotDescriptionError


def read_joint_type(joint: Element) -> JointType:
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


def read_joint_limit(joint: Element) -> JointLimit | None:
    """Return the numbers of a joint's `<limit>` element.

    `effort` and `velocity` are required in it; `lower` and `upper` are 0 if absent, and
    apply only to revolute and prismatic joints.

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


def read_safety_controller(joint: Element) -> SafetyController | None:
    """Return the numbers of a joint's `<safety_controller>` element.

    `k_velocity` is required in it; every other number is 0 if absent.

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
    joint: Element, element: Element, name: str, default: float | None = None
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


def _refuse(joint: Element, problem: str) -> NoReturn:
    name = joint.get("name", "")
    raise RobotDescriptionError(
        f"Joint '{name}' {problem}.",
        remedy=f'Correct the <joint name="{name}"> element of the URDF.',
        details={"joint": name},
    )


_MOST_JOINTS_IN_A_ROW = 256
_Item = TypeVar("_Item", Link, Joint)


def parse_urdf(
    xml: str,
    *,
    source: str | None = None,
    find_mesh: Callable[[str], Path] = Path,
) -> Urdf:
    """Read a robot description and check that it holds together.

    Args:
        xml: The URDF document.
        source: Origin of the document, e.g. a file name; messages begin with it.
        find_mesh: Turns the `filename` of a collision mesh into a path, and raises
            `RobotDescriptionError` if there is no such file. By default the path is
            taken as written, and the file need not exist.

    Returns:
        The robot; every number in it is finite, and its links form one tree.

    Raises:
        RobotDescriptionError: The document is not a URDF, or an element of it is
            missing or wrong.
    """
    try:
        return _Parser(find_mesh).parse(parse_robot(xml))
    except RobotDescriptionError as error:
        if source is None:
            raise
        raise RobotDescriptionError(
            f"{source}: {error.message}", remedy=error.remedy, details=error.details
        ) from error


class _Parser:
    """Read the elements of one document."""

    def __init__(self, find_mesh: Callable[[str], Path]) -> None:
        self._find_mesh = find_mesh

    def parse(self, robot: Element) -> Urdf:
        links = _unique([self._link(e) for e in robot.findall("link")])
        joints = _unique([_joint(e) for e in robot.findall("joint")])
        return Urdf(
            robot.get("name", ""),
            MappingProxyType(links),
            MappingProxyType(joints),
            _find_root(links, joints),
        )

    def _link(self, element: Element) -> Link:
        name = _attribute(element, "name", "A <link>")
        what = f"Link '{name}'"
        inertial = element.find("inertial")
        return Link(
            name,
            None if inertial is None else _inertial(f"{what} <inertial>", inertial),
            tuple(
                self._shape(f"{what} <collision>", e)
                for e in element.findall("collision")
            ),
        )

    def _shape(self, what: str, element: Element) -> Shape:
        origin = _pose(what, element)
        geometry = _child(what, element, "geometry")
        # A comment is a node, too; its tag is not a string.
        shape = next((e for e in geometry if isinstance(e.tag, str)), None)
        if shape is None:
            raise _error(what, "has an empty <geometry>")
        match shape.tag:
            case "mesh":
                scale = _vector(shape, "scale", what, (1.0, 1.0, 1.0))
                return Shape("mesh", origin, scale, self._mesh(what, shape))
            case "box":
                size: tuple[float, ...] = _vector(shape, "size", what, None)
            case "sphere":
                size = (_number(shape, "radius", what),)
            case "cylinder":
                size = (
                    _number(shape, "radius", what),
                    _number(shape, "length", what),
                )
            case other:
                raise _error(what, f"has the unknown geometry <{other}>")
        if min(size) <= 0.0:
            raise _error(what, f"has the size {size}; all lengths must be positive")
        return Shape(shape.tag, origin, size)

    def _mesh(self, what: str, element: Element) -> Path:
        uri = _attribute(element, "filename", what)
        try:
            return self._find_mesh(uri)
        except RobotDescriptionError as exc:
            raise RobotDescriptionError(
                f"{what}: {exc.message}", remedy=exc.remedy
            ) from exc


def _joint(element: Element) -> Joint:
    name = _attribute(element, "name", "A <joint>")
    what = f"Joint '{name}'"
    kind = read_joint_type(element)
    dynamics = element.find("dynamics")
    return Joint(
        name=name,
        type=kind,
        parent=_attribute(_child(what, element, "parent"), "link", what),
        child=_attribute(_child(what, element, "child"), "link", what),
        origin=_pose(what, element),
        axis=_axis(what, element.find("axis"), kind),
        limit=read_joint_limit(element),
        damping=_not_negative(what, dynamics, "damping"),
        friction=_not_negative(what, dynamics, "friction"),
        mimic=_mimic(f"{what} <mimic>", element.find("mimic")),
        safety=read_safety_controller(element),
    )


def _mimic(what: str, element: Element | None) -> Mimic | None:
    if element is None:
        return None
    return Mimic(
        _attribute(element, "joint", what),
        _number(element, "multiplier", what, 1.0),
        _number(element, "offset", what, 0.0),
    )


def _axis(what: str, element: Element | None, kind: JointType) -> Vector3:
    if element is None:
        return (1.0, 0.0, 0.0)
    axis = _vector(element, "xyz", what, None)
    length = math.hypot(*axis)
    if length == 0.0:
        # Some exporters write 0 0 0 for fixed joints, which need no axis.
        if kind is JointType.FIXED:
            return axis
        raise _error(what, "has the axis 0 0 0, which has no direction")
    return (axis[0] / length, axis[1] / length, axis[2] / length)


def _inertial(what: str, element: Element) -> Inertial | None:
    mass = _number(_child(what, element, "mass"), "value", what)
    if mass < 0.0:
        raise _error(what, f"has a mass of {mass} kg; it must not be negative")
    if mass == 0.0:
        return None
    tensor = _child(what, element, "inertia")
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    ixx, iyy, izz, ixy, ixz, iyz = (_number(tensor, key, what) for key in keys)
    return Inertial(mass, _pose(what, element), (ixx, iyy, izz, ixy, ixz, iyz))


def _unique(items: list[_Item]) -> dict[str, _Item]:
    by_name: dict[str, _Item] = {}
    for item in items:
        if item.name in by_name:
            raise _error(f"{type(item).__name__} '{item.name}'", "is defined twice")
        by_name[item.name] = item
    return by_name


def _find_root(links: dict[str, Link], joints: dict[str, Joint]) -> str:
    parent_of: dict[str, str] = {}
    for joint in joints.values():
        what = f"Joint '{joint.name}'"
        for link in (joint.parent, joint.child):
            if link not in links:
                raise _error(what, f"names the link '{link}', which does not exist")
        if joint.child in parent_of:
            raise _error(what, f"gives the link '{joint.child}' a second parent")
        parent_of[joint.child] = joint.parent
        _check_mimic(what, joint.mimic, joints)
    roots = [name for name in links if name not in parent_of]
    if len(roots) != 1:
        raise _error(
            "The <robot>", f"needs exactly one root link, but has {roots or 'none'}"
        )
    _check_connected(roots[0], links, joints)
    return roots[0]


def _check_mimic(what: str, mimic: Mimic | None, joints: dict[str, Joint]) -> None:
    # A chain of mimic joints could close into a loop that no joint drives.
    if mimic is not None and (
        mimic.joint not in joints or joints[mimic.joint].mimic is not None
    ):
        raise _error(what, f"mimics '{mimic.joint}', which is no independent joint")


def _check_connected(
    root: str, links: dict[str, Link], joints: dict[str, Joint]
) -> None:
    children_of: dict[str, list[str]] = {}
    for joint in joints.values():
        children_of.setdefault(joint.parent, []).append(joint.child)
    reached = {root}
    frontier = [root]
    # Readers of the tree recurse into it, so a very long chain would exhaust the stack.
    for _ in range(_MOST_JOINTS_IN_A_ROW):
        frontier = [c for link in frontier for c in children_of.get(link, ())]
        reached.update(frontier)
    if frontier:
        raise _error(
            f"Link '{frontier[0]}'",
            f"hangs on more than {_MOST_JOINTS_IN_A_ROW - 1} joints in a row",
        )
    for name in links:
        if name not in reached:
            raise _error(f"Link '{name}'", "is part of a loop of joints")


def _pose(what: str, element: Element) -> Pose:
    origin = element.find("origin")
    if origin is None:
        return Pose()
    zero = (0.0, 0.0, 0.0)
    return Pose.from_rpy(
        _vector(origin, "xyz", what, zero), _vector(origin, "rpy", what, zero)
    )


def _child(what: str, element: Element, tag: str) -> Element:
    child = element.find(tag)
    if child is None:
        raise _error(what, f"has no <{tag}>")
    return child


def _attribute(element: Element, key: str, what: str) -> str:
    value = element.get(key)
    if not value:
        raise _error(what, f"has a <{element.tag}> without the attribute '{key}'")
    return value


def _number(
    element: Element, key: str, what: str, default: float | None = None
) -> float:
    if default is not None and key not in element.attrib:
        return default
    return _numbers(element, key, what, 1)[0]


def _vector(element: Element, key: str, what: str, default: Vector3 | None) -> Vector3:
    if default is not None and key not in element.attrib:
        return default
    x, y, z = _numbers(element, key, what, 3)
    return (x, y, z)


def _numbers(element: Element, key: str, what: str, count: int) -> list[float]:
    text = _attribute(element, key, what)
    words = text.split()
    numbers = [n for word in words if (n := parse_decimal(word)) is not None]
    if not len(numbers) == len(words) == count:
        raise _error(
            what,
            f'has a <{element.tag}> with {key}="{text}"; {count} finite number(s) '
            "are needed",
        )
    return numbers


def _not_negative(what: str, element: Element | None, key: str) -> float:
    if element is None:
        return 0.0
    value = _number(element, key, what, 0.0)
    if value < 0.0:
        raise _error(what, f"has a <dynamics> with {key} {value}; it must be >= 0")
    return value


def _error(what: str, problem: str) -> RobotDescriptionError:
    return RobotDescriptionError(
        f"{what} {problem}.", remedy="Correct that element of the URDF."
    )
