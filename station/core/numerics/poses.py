"""Poses, rotation vectors and twists as lists of floats, for code outside the cycle.

A pose has 16 numbers, flat and column-major: T(r, c) = T[4 c + r]. A rotation is the
upper left 3 x 3 block of a pose. `rigid_motion` has the same functions for memory that
the caller owns, for code that runs in every cycle. The outer axes of a pose are those
of the frame in which the pose is given.
"""

from collections.abc import Sequence

from station.core.numerics import arm_chain, rigid_motion
from station.memory.doubles import doubles, viewed, zeros


def rotation_between(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Return the rotation vector [rad], shape (3,), that turns one pose to another.

    The vector is expressed in the axes in which both poses are given. Its length is
    from 0 to pi.

    Args:
        first: Pose before the rotation, 16 numbers.
        second: Pose after the rotation, 16 numbers.
    """
    result = zeros(3)
    rigid_motion.rotation_between(viewed(first), viewed(second), result)
    return [*result]


def displace(
    pose: Sequence[float], shift: Sequence[float], turn: Sequence[float]
) -> list[float]:
    """Return a pose moved by a shift and a rotation vector in its outer axes.

    The rotation of the result is orthonormal despite rounding.

    Args:
        pose: The pose, 16 numbers.
        shift: Displacement of the origin [m], shape (3,).
        turn: Rotation vector [rad], shape (3,).
    """
    result = zeros(16)
    rigid_motion.displace(viewed(pose), doubles([*shift, *turn]), 1.0, result)
    return [*result]


def twist_between(
    first: Sequence[float], second: Sequence[float], period: float
) -> list[float]:
    """Return the twist [m/s, rad/s], shape (6,), that leads from one pose to another.

    Args:
        first: Pose before the motion, 16 numbers.
        second: Pose after the motion, 16 numbers.
        period: Time between the poses [s], > 0.
    """
    result = zeros(6)
    rigid_motion.twist_between(viewed(first), viewed(second), period, result)
    return [*result]


def pose_of(position: Sequence[float], quaternion: Sequence[float]) -> list[float]:
    """Return the pose of a position and a quaternion, 16 numbers.

    Args:
        position: Position of the origin [m], shape (3,).
        quaternion: Rotation x, y, z, w; of any length except 0.
    """
    x, y, z, w = quaternion
    s = 2.0 / (x * x + y * y + z * z + w * w)
    return [
        1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), 0.0,
        s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w), 0.0,
        s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y), 0.0,
        position[0], position[1], position[2], 1.0,
    ]  # fmt: skip


def quaternion_of(pose: Sequence[float]) -> list[float]:
    """Return the unit quaternion x, y, z, w of a pose's rotation, with w >= 0."""
    result = zeros(4)
    rigid_motion.quaternion_of(viewed(pose), result)
    return [*result]


def to_outer_axes(pose: Sequence[float], vector: Sequence[float]) -> list[float]:
    """Convert vectors in the axes of a pose to its outer axes, shape (3 n,)."""
    result = zeros(len(vector))
    arm_chain.turn_to_outer_axes(viewed(pose), viewed(vector), result)
    return [*result]


def times(jacobian: Sequence[float], dq: Sequence[float]) -> list[float]:
    """Return J dq, shape (6,).

    Args:
        jacobian: The Jacobian J, 42 numbers, column-major.
        dq: Joint velocities [rad/s], shape (7,).
    """
    result = zeros(6)
    arm_chain.twist_of(viewed(jacobian), viewed(dq), result)
    return [*result]
