"""The model of a robot that a URDF describes: links, joints and their tree.

It holds the inertia and the collision shapes of links, and the origin, axis, limits,
soft limits, friction and mimic rule of joints. Visual shapes are left to the program
that draws the robot, and `<transmission>` elements to
`station.core.hardware.transmissions`. `station.core.description.urdf_parser` reads a
document into this model.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from math import asin, atan2, copysign, cos, dist, hypot, pi, sin
from pathlib import Path

from station.core.errors import RobotDescriptionError

Vector3 = tuple[float, float, float]
"""Three components along x, y and z."""
Quaternion = tuple[float, float, float, float]
"""Rotation as a quaternion of unit length, wxyz."""


class JointType(Enum):
    """The type of a URDF joint."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    FLOATING = "floating"
    PLANAR = "planar"

    @property
    def has_position_limits(self) -> bool:
        """Return whether the position limits of a URDF apply to this type of joint."""
        return self is JointType.REVOLUTE or self is JointType.PRISMATIC

    @property
    def moves(self) -> bool:
        """Return whether a joint of this type has any degree of freedom."""
        return self is not JointType.FIXED

    @property
    def is_rotation(self) -> bool:
        """Return whether a joint of this type turns about its axis."""
        return self is JointType.REVOLUTE or self is JointType.CONTINUOUS


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and orientation of a child frame in its parent frame, T_parent_child.

    Attributes:
        xyz: Translation [m].
        quaternion: Rotation, wxyz, unit length.
    """

    xyz: Vector3 = (0.0, 0.0, 0.0)
    quaternion: Quaternion = (1.0, 0.0, 0.0, 0.0)

    @classmethod
    def from_rpy(cls, xyz: Vector3, rpy: Vector3) -> "Pose":
        """Make a pose from URDF's `xyz` and `rpy` attributes.

        Args:
            xyz: Translation [m].
            rpy: Angles [rad] about the parent's fixed x, then y, then z axis.
        """
        roll, pitch, yaw = (angle / 2.0 for angle in rpy)
        x = (cos(roll), sin(roll), 0.0, 0.0)
        y = (cos(pitch), 0.0, sin(pitch), 0.0)
        z = (cos(yaw), 0.0, 0.0, sin(yaw))
        return cls(xyz, multiply(z, multiply(y, x)))

    def rpy(self) -> Vector3:
        """Return the angles [rad] about the fixed x, then y, then z axis.

        At a pitch of a quarter turn the roll is 0, and the yaw contains both.
        """
        w, x, y, z = self.quaternion
        sine = 2.0 * (w * y - z * x)
        # At a quarter turn the arguments of roll and yaw are 0.
        if abs(sine) > 1.0 - 1e-9:
            return 0.0, copysign(pi / 2.0, sine), 2.0 * atan2(z, w)
        return (
            atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            asin(sine),
            atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
        )

    def inverse(self) -> "Pose":
        """Return T_child_parent."""
        w, x, y, z = self.quaternion
        turned = Pose(quaternion=(w, -x, -y, -z))
        px, py, pz = turned.compose(Pose(self.xyz)).xyz
        return Pose((-px, -py, -pz), turned.quaternion)

    def moved(self, step: "Pose", *, is_by_own_axes: bool) -> "Pose":
        """Return this pose moved by a step.

        Args:
            step: Translation, and rotation about the frame's origin.
            is_by_own_axes: Whether the axes of the step are this frame's, rather than
                the parent's.
        """
        place = self.compose(step) if is_by_own_axes else Pose(self.xyz).compose(step)
        first, then = self.quaternion, step.quaternion
        w, x, y, z = multiply(first, then) if is_by_own_axes else multiply(then, first)
        length = hypot(w, x, y, z)  # so that rounding does not add up over many steps
        turned = (w / length, x / length, y / length, z / length)
        return Pose(place.xyz, turned)

    def compose(self, inner: "Pose") -> "Pose":
        """Return T_a_c, given this pose T_a_b and `inner`, T_b_c."""
        w, x, y, z = self.quaternion
        conjugate = (w, -x, -y, -z)
        turned = multiply(multiply(self.quaternion, (0.0, *inner.xyz)), conjugate)
        xyz = (
            self.xyz[0] + turned[1],
            self.xyz[1] + turned[2],
            self.xyz[2] + turned[3],
        )
        return Pose(xyz, multiply(self.quaternion, inner.quaternion))


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the quaternion of the rotation `b` followed by the rotation `a`."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass properties of a link.

    Attributes:
        mass: Mass [kg], > 0.
        origin: Frame at the centre of mass, in the link frame.
        inertia: Inertia about the centre of mass, in the axes of `origin` [kg m^2]:
            ixx, iyy, izz, ixy, ixz, iyz.
    """

    mass: float
    origin: Pose
    inertia: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Shape:
    """A collision shape of a link.

    Attributes:
        kind: `mesh`, `box`, `sphere` or `cylinder`.
        origin: The shape's frame in the link frame.
        size: Box: edge lengths [m]; sphere: (radius,) [m]; cylinder: (radius, length)
            [m]; mesh: scale factors.
        mesh: The mesh file, or None for the other kinds.
    """

    kind: str
    origin: Pose
    size: tuple[float, ...]
    mesh: Path | None = None


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body of the robot.

    Attributes:
        name: Unique among the links.
        inertial: Its mass properties; None for a link without mass.
        collisions: Its collision shapes, in the order of the document.
    """

    name: str
    inertial: Inertial | None
    collisions: tuple[Shape, ...]

    @property
    def is_frame_only(self) -> bool:
        """Return whether the link has neither mass nor a collision shape."""
        return self.inertial is None and not self.collisions


@dataclass(frozen=True, slots=True)
class Mimic:
    """The rule by which a joint follows another: q = multiplier * q_joint + offset.

    Attributes:
        joint: Name of the joint that is followed.
        multiplier: Factor of that joint's position.
        offset: Addition to the product [rad] or [m].
    """

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class JointLimit:
    """The numbers of a joint's `<limit>` element, as they are written there.

    Attributes:
        lower: Lowest position [rad] or [m]; None unless the joint is revolute or
            prismatic.
        upper: Highest position [rad] or [m]; None together with `lower`.
        velocity: Highest speed [rad/s] or [m/s].
        effort: Highest effort [N*m] or [N].
    """

    lower: float | None
    upper: float | None
    velocity: float
    effort: float


@dataclass(frozen=True, slots=True)
class SafetyController:
    """The numbers of a joint's `<safety_controller>` element: its soft limits.

    Attributes:
        soft_lower_limit: Position below which the joint is slowed down [rad] or [m].
        soft_upper_limit: Position above which the joint is slowed down [rad] or [m].
        k_position: Velocity bound per distance to a soft limit [1/s].
        k_velocity: Effort bound per excess of velocity [N*m*s/rad or N*s/m].
    """

    soft_lower_limit: float
    soft_upper_limit: float
    k_position: float
    k_velocity: float


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between two links.

    Attributes:
        name: Unique among the joints.
        type: Type of the joint.
        parent: Name of the link on the base's side.
        child: Name of the link on the tool's side.
        origin: Child frame in the parent frame at position zero.
        axis: Unit vector in the child frame.
        limit: Its limits; None if it has no `<limit>`, which revolute and prismatic
            joints always have.
        damping: Damping [Nm s/rad] or [N s/m], >= 0.
        friction: Friction [Nm] or [N], >= 0.
        mimic: The rule by which it follows another joint, or None.
        safety: Its soft limits, or None if it has no `<safety_controller>`.
    """

    name: str
    type: JointType
    parent: str
    child: str
    origin: Pose
    axis: Vector3
    limit: JointLimit | None
    damping: float
    friction: float
    mimic: Mimic | None
    safety: SafetyController | None


@dataclass(frozen=True, slots=True)
class Urdf:
    """A robot's links and joints, in the order of the document.

    Attributes:
        name: The robot's name.
        links: The links by name.
        joints: The joints by name.
        root: Name of the one link that is not the child of a joint.
    """

    name: str
    links: Mapping[str, Link]
    joints: Mapping[str, Joint]
    root: str
    _below: dict[str, list[Joint]] = field(init=False, repr=False, compare=False)
    _above: dict[str, Joint] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        below: dict[str, list[Joint]] = {}
        for joint in self.joints.values():
            below.setdefault(joint.parent, []).append(joint)
        object.__setattr__(self, "_below", below)
        above = {joint.child: joint for joint in self.joints.values()}
        object.__setattr__(self, "_above", above)

    def joints_below(self, link: str) -> list[Joint]:
        """Return the joints whose parent is `link`, in the order of the document."""
        return list(self._below.get(link, ()))

    def joint_above(self, link: str) -> Joint | None:
        """Return the joint whose child is `link`; None for the root."""
        return self._above.get(link)

    def fixed_root(self, link: str) -> tuple[str, Pose]:
        """Return the link at the root of the fixed joints above a link, and the pose.

        Args:
            link: Name of a link.

        Returns:
            The name of that root, which is `link` itself below a joint that moves, and
            the pose of `link` in the frame of the root.
        """
        pose = Pose()
        joint = self.joint_above(link)
        while joint is not None and joint.type is JointType.FIXED:
            pose = joint.origin.compose(pose)
            link = joint.parent
            joint = self.joint_above(link)
        return link, pose


def wheel_separation(urdf: Urdf, left: str, right: str) -> float:
    """Return the distance between the origins of two wheel joints [m].

    Args:
        urdf: The robot.
        left: Name of the left wheel's joint.
        right: Name of the right wheel's joint; both hang on the same link.

    Raises:
        RobotDescriptionError: There is no such joint, or the distance is 0.
    """
    first, second = _joint(urdf, left), _joint(urdf, right)
    distance = dist(first.origin.xyz, second.origin.xyz)
    if distance == 0.0:
        raise RobotDescriptionError(
            f"The wheel joints '{left}' and '{right}' have the same origin.",
            remedy="Give the parameter wheel_separation.",
        )
    return distance


def wheel_radius(urdf: Urdf, joint: str) -> float:
    """Return the radius of a wheel, the link that a joint turns [m].

    Args:
        urdf: The robot.
        joint: Name of the wheel's joint.

    Raises:
        RobotDescriptionError: There is no such joint, or the first collision shape of
            its link is neither a cylinder nor a sphere.
    """
    link = urdf.links[_joint(urdf, joint).child]
    shape: Shape | None = link.collisions[0] if link.collisions else None
    if shape is None or shape.kind not in ("cylinder", "sphere"):
        found = "none" if shape is None else shape.kind
        raise RobotDescriptionError(
            f"The wheel '{link.name}' has as first collision shape {found}; a radius "
            "can be read from a cylinder or a sphere.",
            remedy="Give the parameter wheel_radius.",
            details={"link": link.name},
        )
    return shape.size[0]


def _joint(urdf: Urdf, name: str) -> Joint:
    joint = urdf.joints.get(name)
    if joint is None:
        raise RobotDescriptionError(
            f"The robot description has no joint '{name}'.",
            remedy=f"It has: {', '.join(urdf.joints) or 'none'}.",
            details={"resource": name},
        )
    return joint
