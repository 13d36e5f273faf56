"""Read and check a URDF: every refusal names the file, the element and the reason."""

import math
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from station.core.errors import RobotDescriptionError
from station.core.hardware.limits import (
    JointLimitsError,
    joint_limits_from_urdf,
    soft_joint_limits_from_urdf,
)
from station.hw.robot_description import RobotDescription
from station.hw.urdf import (
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

_MOST_JOINTS_IN_A_ROW = 256
_Item = TypeVar("_Item", Link, Joint)


def parse_urdf(description: RobotDescription) -> Urdf:
    """Read and check a robot description.

    Args:
        description: A description found by `load_robot_description`.

    Returns:
        The robot; every number in it is finite, its links form one tree, and every
        collision mesh exists.

    Raises:
        RobotDescriptionError: A part is missing, wrong or cannot be simulated; the
            message names the file, the element and the reason.
    """
    return _Parser(description).parse()


class _Parser:
    """One pass over one file; keeps the file's name for the messages."""

    def __init__(self, description: RobotDescription) -> None:
        self._description = description

    def parse(self) -> Urdf:
        robot = ElementTree.fromstring(self._description.xml)
        links = self._unique([self._link(e) for e in robot.findall("link")])
        joints = self._unique([self._joint(e) for e in robot.findall("joint")])
        root = self._check_tree(links, joints)
        return Urdf(
            robot.get("name", ""),
            MappingProxyType(links),
            MappingProxyType(joints),
            root,
        )

    def _error(self, element: str, reason: str) -> RobotDescriptionError:
        return RobotDescriptionError(
            f"{self._description.urdf_path}: {element}: {reason}",
            remedy="correct that element of the URDF",
        )

    def _located(self, error: RobotDescriptionError) -> RobotDescriptionError:
        """Return an error that names the element already, with the file's name."""
        return RobotDescriptionError(
            f"{self._description.urdf_path}: {error.message}", remedy=error.remedy
        )

    def _unique(self, items: list[_Item]) -> dict[str, _Item]:
        by_name: dict[str, _Item] = {}
        for item in items:
            if item.name in by_name:
                what = "link" if isinstance(item, Link) else "joint"
                raise self._error(f"{what} {item.name!r}", "is defined twice")
            by_name[item.name] = item
        return by_name

    def _check_tree(self, links: dict[str, Link], joints: dict[str, Joint]) -> str:
        parent_of: dict[str, str] = {}
        for joint in joints.values():
            what = f"joint {joint.name!r}"
            for link in (joint.parent, joint.child):
                if link not in links:
                    raise self._error(what, f"names the link {link!r} that is missing")
            if joint.child in parent_of:
                raise self._error(what, f"gives {joint.child!r} a second parent")
            parent_of[joint.child] = joint.parent
            mimic = joint.mimic
            if mimic is not None and (
                mimic.joint not in joints or joints[mimic.joint].mimic is not None
            ):
                raise self._error(
                    what, f"mimics {mimic.joint!r}, which is no independent joint"
                )
        roots = [name for name in links if name not in parent_of]
        if len(roots) != 1:
            raise self._error(
                "<robot>", f"needs exactly one root link, but has {roots or 'none'}"
            )
        self._check_connected(roots[0], links, joints)
        return roots[0]

    def _check_connected(
        self, root: str, links: dict[str, Link], joints: dict[str, Joint]
    ) -> None:
        children_of: dict[str, list[str]] = {}
        for joint in joints.values():
            children_of.setdefault(joint.parent, []).append(joint.child)
        reached = {root}
        frontier = [root]
        for _ in range(_MOST_JOINTS_IN_A_ROW):
            frontier = [c for link in frontier for c in children_of.get(link, ())]
            reached.update(frontier)
        if frontier:
            raise self._error(
                f"link {frontier[0]!r}",
                f"hangs on more than {_MOST_JOINTS_IN_A_ROW - 1} joints in a row",
            )
        for name in links:
            if name not in reached:
                raise self._error(f"link {name!r}", "is part of a loop of joints")

    def _link(self, element: Element) -> Link:
        name = self._name(element)
        what = f"link {name!r}"
        inertial = element.find("inertial")
        collisions = [self._shape(what, e) for e in element.findall("collision")]
        return Link(
            name,
            None if inertial is None else self._inertial(what, inertial),
            tuple(collisions),
        )

    def _inertial(self, what: str, element: Element) -> Inertial | None:
        what = f"{what} <inertial>"
        mass = self._number(self._child(what, element, "mass"), "value", what)
        if mass < 0.0:
            raise self._error(what, f"mass is {mass} kg, but must not be negative")
        if mass == 0.0:
            return None
        tensor = self._child(what, element, "inertia")
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        ixx, iyy, izz, ixy, ixz, iyz = (self._number(tensor, k, what) for k in keys)
        return Inertial(mass, self._pose(what, element), (ixx, iyy, izz, ixy, ixz, iyz))

    def _shape(self, what: str, element: Element) -> Shape:
        what = f"{what} <collision>"
        origin = self._pose(what, element)
        geometry = self._child(what, element, "geometry")
        for shape in geometry:
            match shape.tag:
                case "mesh":
                    file = self._mesh(what, shape)
                    scale = self._vector(shape, "scale", what, (1.0, 1.0, 1.0))
                    return Shape("mesh", origin, scale, file)
                case "box":
                    size = self._vector(shape, "size", what, None)
                    return Shape("box", origin, self._positive(what, size))
                case "sphere":
                    radius = self._number(shape, "radius", what)
                    return Shape("sphere", origin, self._positive(what, (radius,)))
                case "cylinder":
                    size2 = (
                        self._number(shape, "radius", what),
                        self._number(shape, "length", what),
                    )
                    return Shape("cylinder", origin, self._positive(what, size2))
                case other:
                    raise self._error(what, f"has the unknown geometry <{other}>")
        raise self._error(what, "has an empty <geometry>")

    def _mesh(self, what: str, element: Element) -> Path:
        uri = self._attribute(element, "filename", what)
        try:
            return self._description.resolve_mesh(uri)
        except RobotDescriptionError as exc:
            reason = exc.message.removeprefix(f"{self._description.urdf_path}: ")
            raise RobotDescriptionError(
                f"{self._description.urdf_path}: {what}: {reason}", remedy=exc.remedy
            ) from exc

    def _joint(self, element: Element) -> Joint:
        name = self._name(element)
        what = f"joint {name!r}"
        try:
            kind = JointType(element.get("type", ""))
        except ValueError as exc:
            allowed = ", ".join(t.value for t in JointType)
            raise self._error(
                what, f"has type {element.get('type')!r}; use one of {allowed}"
            ) from exc
        axis = element.find("axis")
        dynamics = element.find("dynamics")
        return Joint(
            name=name,
            type=kind,
            parent=self._attribute(self._child(what, element, "parent"), "link", what),
            child=self._attribute(self._child(what, element, "child"), "link", what),
            origin=self._pose(what, element),
            axis=(1.0, 0.0, 0.0) if axis is None else self._axis(what, axis, kind),
            limit=self._limit(what, element, kind),
            damping=self._not_negative(what, dynamics, "damping"),
            friction=self._not_negative(what, dynamics, "friction"),
            mimic=self._mimic(what, element.find("mimic")),
            safety=self._safety(element),
        )

    def _limit(self, what: str, element: Element, kind: JointType) -> JointLimit | None:
        if kind is JointType.FIXED:
            return None
        try:
            limits = joint_limits_from_urdf(element)
        except RobotDescriptionError as exc:
            raise self._located(exc) from exc
        if limits is None:
            return None
        what = f"{what} <limit>"
        lower, upper = limits.min_position, limits.max_position
        if lower is not None and upper is not None and lower >= upper:
            raise RobotDescriptionError(
                f"{self._description.urdf_path}: {what}: lower {lower} is not below "
                f"upper {upper}",
                remedy="give the joint a range, or make it continuous or fixed",
            )
        velocity, effort = limits.max_velocity or 0.0, limits.max_effort or 0.0
        if effort < 0.0 or velocity < 0.0:
            raise self._error(what, "effort and velocity must not be negative")
        return JointLimit(lower, upper, velocity, effort)

    def _mimic(self, what: str, element: Element | None) -> Mimic | None:
        if element is None:
            return None
        what = f"{what} <mimic>"
        return Mimic(
            self._attribute(element, "joint", what),
            self._number(element, "multiplier", what, 1.0),
            self._number(element, "offset", what, 0.0),
        )

    def _safety(self, element: Element) -> SafetyController | None:
        try:
            soft = soft_joint_limits_from_urdf(element)
            if soft is None:
                return None
            soft.validate(element.get("name", ""))
        except RobotDescriptionError as exc:
            raise self._located(exc) from exc
        except JointLimitsError as exc:
            raise self._error("<safety_controller>", exc.message) from exc
        return SafetyController(
            soft.min_position, soft.max_position, soft.k_position, soft.k_velocity
        )

    def _axis(self, what: str, element: Element, kind: JointType) -> Vector3:
        axis = self._vector(element, "xyz", what, None)
        length = math.hypot(*axis)
        if length == 0.0:
            if kind is JointType.FIXED:
                return axis
            raise self._error(what, "has the axis 0 0 0")
        return (axis[0] / length, axis[1] / length, axis[2] / length)

    def _pose(self, what: str, element: Element) -> Pose:
        origin = element.find("origin")
        if origin is None:
            return Pose()
        zero = (0.0, 0.0, 0.0)
        return Pose.from_rpy(
            self._vector(origin, "xyz", what, zero),
            self._vector(origin, "rpy", what, zero),
        )

    def _name(self, element: Element) -> str:
        return self._attribute(element, "name", f"<{element.tag}>")

    def _child(self, what: str, element: Element, tag: str) -> Element:
        child = element.find(tag)
        if child is None:
            raise self._error(what, f"has no <{tag}>")
        return child

    def _attribute(self, element: Element, key: str, what: str) -> str:
        value = element.get(key)
        if not value:
            raise self._error(what, f"<{element.tag}> has no attribute {key!r}")
        return value

    def _number(
        self, element: Element, key: str, what: str, default: float | None = None
    ) -> float:
        if default is not None and key not in element.attrib:
            return default
        return self._numbers(element, key, what, 1)[0]

    def _vector(
        self, element: Element, key: str, what: str, default: Vector3 | None
    ) -> Vector3:
        if default is not None and key not in element.attrib:
            return default
        x, y, z = self._numbers(element, key, what, 3)
        return (x, y, z)

    def _numbers(self, element: Element, key: str, what: str, n: int) -> list[float]:
        text = self._attribute(element, key, what)
        try:
            numbers = [float(word) for word in text.split()]
        except ValueError:
            numbers = []
        if len(numbers) != n or not all(map(math.isfinite, numbers)):
            raise self._error(
                what,
                f"<{element.tag}> {key} is {text!r}; needs {n} finite number(s)",
            )
        return numbers

    def _positive(self, what: str, size: tuple[float, ...]) -> tuple[float, ...]:
        if min(size) <= 0.0:
            raise self._error(what, f"has the size {size}; must be positive")
        return size

    def _not_negative(self, what: str, element: Element | None, key: str) -> float:
        if element is None:
            return 0.0
        value = self._number(element, key, what, 0.0)
        if value < 0.0:
            raise self._error(what, f"<dynamics> {key} is {value}; must be >= 0")
        return value
