"""A robot as its URDF describes it: links, joints and their tree, as typed values.

Only what a simulation of rigid bodies needs is kept: inertia and collision shapes of
links; origin, axis, limits, friction and mimic of joints. Visual shapes are left to
the browser. `station.hw.urdf_parser` reads the files.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from math import asin, atan2, cos, sin
from pathlib import Path

Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class JointType(Enum):
    """The kinds of URDF joint that can be simulated."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a child frame stands in its parent frame.

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
        return cls(xyz, _multiply(z, _multiply(y, x)))

    def rpy(self) -> Vector3:
        """Return the angles [rad] about the fixed x, then y, then z axis."""
        w, x, y, z = self.quaternion
        return (
            atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x)))),
            atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
        )

    def compose(self, inner: "Pose") -> "Pose":
        """Return T_a_c of this pose T_a_b and `inner`, T_b_c."""
        w, x, y, z = self.quaternion
        conjugate = (w, -x, -y, -z)
        turned = _multiply(_multiply(self.quaternion, (0.0, *inner.xyz)), conjugate)
        xyz = (
            self.xyz[0] + turned[1],
            self.xyz[1] + turned[2],
            self.xyz[2] + turned[3],
        )
        return Pose(xyz, _multiply(self.quaternion, inner.quaternion))


def _multiply(a: Quaternion, b: Quaternion) -> Quaternion:
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
        mass: [kg], > 0.
        origin: Frame at the centre of mass, in the link frame.
        inertia: About the centre of mass, in the axes of `origin` [kg m^2]:
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
        mesh: The mesh file, or None for a primitive.
    """

    kind: str
    origin: Pose
    size: tuple[float, ...]
    mesh: Path | None = None


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body; massless and without shapes it is but a frame."""

    name: str
    inertial: Inertial | None
    collisions: tuple[Shape, ...]

    @property
    def is_frame_only(self) -> bool:
        """The link has neither mass nor a collision shape."""
        return self.inertial is None and not self.collisions


@dataclass(frozen=True, slots=True)
class Mimic:
    """position = multiplier * position of `joint` + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class JointLimit:
    """The `<limit>` of a joint.

    Attributes:
        lower: [rad] or [m]; None for a continuous joint.
        upper: [rad] or [m]; None for a continuous joint.
        velocity: > 0 [rad/s] or [m/s].
        effort: >= 0 [Nm] or [N].
    """

    lower: float | None
    upper: float | None
    velocity: float
    effort: float


@dataclass(frozen=True, slots=True)
class SafetyController:
    """The `<safety_controller>` of a joint: its soft limits.

    Attributes:
        soft_lower_limit: [rad] or [m].
        soft_upper_limit: [rad] or [m].
        k_position: Velocity bound per distance to a soft limit [1/s].
        k_velocity: Effort bound per excess of velocity [Nm s/rad or N s/m].
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
        type: Its kind.
        parent: Link on the base's side.
        child: Link on the tool's side.
        origin: Child frame in the parent frame at position zero.
        axis: Unit vector in the child frame.
        limit: None if the URDF states none (continuous and fixed joints only).
        damping: [Nm s/rad] or [N s/m], >= 0.
        friction: [Nm] or [N], >= 0.
        mimic: The joint that it follows, or None.
        safety: Its soft limits, or None.
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
    """A robot's links and joints, in the order of the file.

    Attributes:
        name: The robot's name in the file.
        links: By name.
        joints: By name.
        root: The one link that is no joint's child.
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
        """Return the joints whose parent is `link`, in the order of the file."""
        return list(self._below.get(link, ()))

    def joint_above(self, link: str) -> Joint | None:
        """Return the joint whose child is `link`; None for the root."""
        return self._above.get(link)
