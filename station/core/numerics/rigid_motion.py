"""Poses, rotation vectors and twists in plain floats.

A pose has 16 numbers, flat and column-major: T(r, c) = T[4 c + r]. A rotation is the
upper left 3 x 3 block of a pose.
"""

from collections.abc import Sequence
from math import acos, atan2, cos, pi, sin, sqrt

_SMALL = 1e-9


def rotation_between(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Return the rotation vector [rad], shape (3,), that turns one pose to another.

    The vector is expressed in the axes in which both poses are given. Its length is
    from 0 to pi.

    Args:
        first: Pose before the rotation, 16 numbers.
        second: Pose after the rotation, 16 numbers.
    """
    # R = R_second R_first^T, element by element: this runs several times in each cycle.
    a0, a1, a2, _, b0, b1, b2, _, c0, c1, c2 = first[:11]
    d0, d1, d2, _, e0, e1, e2, _, f0, f1, f2 = second[:11]
    x = d2 * a1 + e2 * b1 + f2 * c1 - d1 * a2 - e1 * b2 - f1 * c2
    y = d0 * a2 + e0 * b2 + f0 * c2 - d2 * a0 - e2 * b0 - f2 * c0
    z = d1 * a0 + e1 * b0 + f1 * c0 - d0 * a1 - e0 * b1 - f0 * c1
    diagonal = (
        d0 * a0 + e0 * b0 + f0 * c0,
        d1 * a1 + e1 * b1 + f1 * c1,
        d2 * a2 + e2 * b2 + f2 * c2,
    )
    sine = sqrt(x * x + y * y + z * z) / 2.0
    cosine = (diagonal[0] + diagonal[1] + diagonal[2] - 1.0) / 2.0
    if sine > _SMALL:
        scale = atan2(sine, cosine) / (2.0 * sine)
        return [scale * x, scale * y, scale * z]
    if cosine > 0.0:
        return [x / 2.0, y / 2.0, z / 2.0]
    # Half a turn: in R = 2 k k^T - 1, each column of R + 1 is parallel to the axis k.
    lengths = [sqrt(max(0.0, (value + 1.0) / 2.0)) for value in diagonal]
    largest = lengths.index(max(lengths))
    axis = [
        sum(second[4 * k + i] * first[4 * k + largest] for k in range(3))
        / (2.0 * lengths[largest])
        for i in range(3)
    ]
    axis[largest] = lengths[largest]
    angle = pi if cosine <= -1.0 else acos(cosine)
    return [angle * value for value in axis]


def displace(
    pose: Sequence[float], shift: Sequence[float], turn: Sequence[float]
) -> list[float]:
    """Return a pose moved by a shift and a rotation vector, given in the outer axes.

    The rotation of the result is orthonormal despite rounding.

    Args:
        pose: The pose, 16 numbers.
        shift: Displacement of the origin [m], shape (3,).
        turn: Rotation vector [rad], shape (3,).
    """
    angle = sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
    result = list(pose)
    if angle > 0.0:
        kx, ky, kz = (value / angle for value in turn)
        c, s = cos(angle), sin(angle)
        for column in (0, 4, 8):
            vx, vy, vz = pose[column : column + 3]
            dot = (kx * vx + ky * vy + kz * vz) * (1.0 - c)
            result[column] = c * vx + s * (ky * vz - kz * vy) + kx * dot
            result[column + 1] = c * vy + s * (kz * vx - kx * vz) + ky * dot
            result[column + 2] = c * vz + s * (kx * vy - ky * vx) + kz * dot
    _orthonormalise(result)
    result[12] += shift[0]
    result[13] += shift[1]
    result[14] += shift[2]
    return result


def _orthonormalise(pose: list[float]) -> None:
    """Make the rotation of a pose orthonormal, keeping the direction of its x axis."""
    ax, ay, az = pose[0:3]
    length = sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax / length, ay / length, az / length
    bx, by, bz = pose[4:7]
    dot = ax * bx + ay * by + az * bz
    bx, by, bz = bx - dot * ax, by - dot * ay, bz - dot * az
    length = sqrt(bx * bx + by * by + bz * bz)
    bx, by, bz = bx / length, by / length, bz / length
    pose[0:3] = [ax, ay, az]
    pose[4:7] = [bx, by, bz]
    pose[8:11] = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]


def twist_between(
    first: Sequence[float], second: Sequence[float], period: float
) -> list[float]:
    """Return the twist [m/s, rad/s], shape (6,), that leads from one pose to another.

    Args:
        first: Pose before the motion, 16 numbers.
        second: Pose after the motion, 16 numbers.
        period: Time between the poses [s], > 0.
    """
    turn = rotation_between(first, second)
    return [
        (second[12] - first[12]) / period,
        (second[13] - first[13]) / period,
        (second[14] - first[14]) / period,
        turn[0] / period,
        turn[1] / period,
        turn[2] / period,
    ]


def pose_of(position: Sequence[float], quaternion: Sequence[float]) -> list[float]:
    """Return a pose, 16 numbers.

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
    xx, yy, zz = pose[0], pose[5], pose[10]
    # Dividing by the largest component is safe.
    squares = [1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz]
    squares.append(1.0 + xx + yy + zz)
    largest = squares.index(max(squares))
    xy, xz, yz = pose[1] + pose[4], pose[2] + pose[8], pose[6] + pose[9]
    xw, yw, zw = pose[6] - pose[9], pose[8] - pose[2], pose[1] - pose[4]
    row = (
        (squares[0], xy, xz, xw),
        (xy, squares[1], yz, yw),
        (xz, yz, squares[2], zw),
        (xw, yw, zw, squares[3]),
    )[largest]
    size = 2.0 * sqrt(squares[largest])
    sign = -1.0 if row[3] < 0.0 else 1.0
    return [sign * value / size for value in row]


def to_outer_axes(pose: Sequence[float], vector: Sequence[float]) -> list[float]:
    """Return a vector, given in the axes of a pose, in the pose's outer axes, (3,)."""
    x, y, z = vector
    return [pose[i] * x + pose[4 + i] * y + pose[8 + i] * z for i in range(3)]


def to_inner_axes(pose: Sequence[float], vector: Sequence[float]) -> list[float]:
    """Return a vector, given in the outer axes of a pose, in the pose's axes, (3,)."""
    return [sum(pose[4 * i + k] * vector[k] for k in range(3)) for i in range(3)]


def times(jacobian: Sequence[float], dq: Sequence[float]) -> list[float]:
    """Return J dq, shape (6,).

    Args:
        jacobian: The Jacobian J, 42 numbers, column-major.
        dq: Joint velocities [rad/s], shape (7,).
    """
    result = [0.0] * 6
    for joint, rate in enumerate(dq):
        if rate:
            for row in range(6):
                result[row] += jacobian[6 * joint + row] * rate
    return result
