"""Poses, rotation vectors and twists in memory that the caller owns.

A pose has 16 numbers, flat and column-major: T(r, c) = T[4 c + r]. Its last row is not
read, and is written as 0 0 0 1. A result may be written over an argument. The outer
axes of a pose are those of the frame in which the pose is given.
"""

from station.memory.doubles import Doubles, Storage
from station.memory.functions import arctangent, cosine, sine, square_root

SMALL = 1e-9
"""Sine below which an angle counts as 0, or as half a turn."""


def compose(first: Storage, second: Doubles, result: Doubles) -> None:
    """Write T_a_c of the poses T_a_b and T_b_c.

    Args:
        first: T_a_b, 16 numbers.
        second: T_b_c, 16 numbers.
        result: Receives T_a_c, 16 numbers.
    """
    a, b, c, e, f, g = first[0], first[1], first[2], first[4], first[5], first[6]
    i, j, k, x, y, z = first[8], first[9], first[10], first[12], first[13], first[14]
    for column in range(0, 12, 4):
        p, q, r = second[column], second[column + 1], second[column + 2]
        result[column] = a * p + e * q + i * r
        result[column + 1] = b * p + f * q + j * r
        result[column + 2] = c * p + g * q + k * r
        result[column + 3] = 0.0
    p, q, r = second[12], second[13], second[14]
    result[12] = a * p + e * q + i * r + x
    result[13] = b * p + f * q + j * r + y
    result[14] = c * p + g * q + k * r + z
    result[15] = 1.0


def rotation_between(first: Doubles, second: Doubles, result: Doubles) -> None:
    """Write the rotation vector that turns one pose to another [rad].

    The vector is expressed in the axes in which both poses are given. Its length is
    from 0 to pi.

    Args:
        first: Pose before the rotation, 16 numbers.
        second: Pose after the rotation, 16 numbers.
        result: Receives the vector, shape (3,) or longer.
    """
    # R = R_second R_first^T, element by element.
    a0, a1, a2 = first[0], first[1], first[2]
    b0, b1, b2 = first[4], first[5], first[6]
    c0, c1, c2 = first[8], first[9], first[10]
    d0, d1, d2 = second[0], second[1], second[2]
    e0, e1, e2 = second[4], second[5], second[6]
    f0, f1, f2 = second[8], second[9], second[10]
    x = d2 * a1 + e2 * b1 + f2 * c1 - d1 * a2 - e1 * b2 - f1 * c2
    y = d0 * a2 + e0 * b2 + f0 * c2 - d2 * a0 - e2 * b0 - f2 * c0
    z = d1 * a0 + e1 * b0 + f1 * c0 - d0 * a1 - e0 * b1 - f0 * c1
    xx = d0 * a0 + e0 * b0 + f0 * c0
    yy = d1 * a1 + e1 * b1 + f1 * c1
    zz = d2 * a2 + e2 * b2 + f2 * c2
    sin_angle = square_root(x * x + y * y + z * z) / 2.0
    cos_angle = (xx + yy + zz - 1.0) / 2.0
    if sin_angle > SMALL:
        scale = arctangent(sin_angle, cos_angle) / (2.0 * sin_angle)
        result[0], result[1], result[2] = scale * x, scale * y, scale * z
        return
    if not cos_angle < 0.0:
        result[0], result[1], result[2] = x / 2.0, y / 2.0, z / 2.0
        return
    # Half a turn: in R = 2 k k^T - 1, each column of R + 1 is parallel to the axis k.
    x, y, z = xx + 1.0, d1 * a0 + e1 * b0 + f1 * c0, d2 * a0 + e2 * b0 + f2 * c0
    if yy > xx and yy >= zz:
        x, y, z = d0 * a1 + e0 * b1 + f0 * c1, yy + 1.0, d2 * a1 + e2 * b1 + f2 * c1
    elif zz > xx:
        x, y, z = d0 * a2 + e0 * b2 + f0 * c2, d1 * a2 + e1 * b2 + f1 * c2, zz + 1.0
    # The length is at least 4/3 unless the poses have no rotations.
    length = square_root(x * x + y * y + z * z)
    scale = arctangent(sin_angle, cos_angle) / length if length > 0.0 else 0.0
    result[0], result[1], result[2] = scale * x, scale * y, scale * z


def twist_between(
    first: Doubles, second: Doubles, period: float, result: Doubles
) -> None:
    """Write the twist that leads from one pose to another [m/s, rad/s].

    Args:
        first: Pose before the motion, 16 numbers.
        second: Pose after the motion, 16 numbers.
        period: Time between the poses [s], > 0.
        result: Receives the twist, shape (6,) or longer; not one of the poses.
    """
    rotation_between(first, second, result)
    result[3] = result[0] / period
    result[4] = result[1] / period
    result[5] = result[2] / period
    result[0] = (second[12] - first[12]) / period
    result[1] = (second[13] - first[13]) / period
    result[2] = (second[14] - first[14]) / period


def displace(pose: Doubles, way: Doubles, share: float, result: Doubles) -> None:
    """Write a pose moved by a translation and a rotation vector in the outer axes.

    The rotation of the result is orthonormal despite rounding, if that of the pose
    nearly is; its x axis keeps its direction.

    Args:
        pose: The pose, 16 numbers.
        way: Displacement of the origin [m], then rotation vector [rad], shape (6,).
        share: Factor of both.
        result: Receives the moved pose, 16 numbers.
    """
    kx, ky, kz = share * way[3], share * way[4], share * way[5]
    ax, ay, az, bx, by, bz = pose[0], pose[1], pose[2], pose[4], pose[5], pose[6]
    angle = square_root(kx * kx + ky * ky + kz * kz)
    if angle > 0.0:
        kx, ky, kz = kx / angle, ky / angle, kz / angle
        # A rotation vector that is not finite makes the rotation NaN.
        angle += angle - angle
        c, s = cosine(angle), sine(angle)
        dot = (kx * ax + ky * ay + kz * az) * (1.0 - c)
        ax, ay, az = (
            c * ax + s * (ky * az - kz * ay) + kx * dot,
            c * ay + s * (kz * ax - kx * az) + ky * dot,
            c * az + s * (kx * ay - ky * ax) + kz * dot,
        )
        dot = (kx * bx + ky * by + kz * bz) * (1.0 - c)
        bx, by, bz = (
            c * bx + s * (ky * bz - kz * by) + kx * dot,
            c * by + s * (kz * bx - kx * bz) + ky * dot,
            c * bz + s * (kx * by - ky * bx) + kz * dot,
        )
    length = square_root(ax * ax + ay * ay + az * az)
    if length > 0.0:
        ax, ay, az = ax / length, ay / length, az / length
    dot = ax * bx + ay * by + az * bz
    bx, by, bz = bx - dot * ax, by - dot * ay, bz - dot * az
    length = square_root(bx * bx + by * by + bz * bz)
    if length > 0.0:
        bx, by, bz = bx / length, by / length, bz / length
    x, y, z = pose[12], pose[13], pose[14]
    result[0], result[1], result[2], result[3] = ax, ay, az, 0.0
    result[4], result[5], result[6], result[7] = bx, by, bz, 0.0
    result[8] = ay * bz - az * by
    result[9] = az * bx - ax * bz
    result[10] = ax * by - ay * bx
    result[11] = 0.0
    result[12] = x + share * way[0]
    result[13] = y + share * way[1]
    result[14] = z + share * way[2]
    result[15] = 1.0


def numbers_of(pose: Doubles, near: Doubles, result: Doubles) -> None:
    """Write the position and the unit quaternion x, y, z, w of a pose.

    Args:
        pose: The pose, 16 numbers.
        near: Of the two quaternions of the rotation, the one nearer to this one is
            written, so that numbers of a motion do not jump; shape (4,).
        result: Receives the numbers, shape (7,).
    """
    quaternion_of(pose, result)
    x, y, z, w = result[0], result[1], result[2], result[3]
    if x * near[0] + y * near[1] + z * near[2] + w * near[3] < 0.0:
        x, y, z, w = -x, -y, -z, -w
    result[0], result[1], result[2] = pose[12], pose[13], pose[14]
    result[3], result[4], result[5], result[6] = x, y, z, w


def quaternion_of(pose: Doubles, result: Doubles) -> None:
    """Write the unit quaternion x, y, z, w of a pose's rotation, with w >= 0.

    Args:
        pose: The pose, 16 numbers.
        result: Receives the quaternion, shape (4,) or longer.
    """
    xx, yy, zz = pose[0], pose[5], pose[10]
    xy, xz, yz = pose[1] + pose[4], pose[2] + pose[8], pose[6] + pose[9]
    xw, yw, zw = pose[6] - pose[9], pose[8] - pose[2], pose[1] - pose[4]
    # Dividing by the largest component is safe; each row is 4 times a component times
    # the quaternion.
    x, y, z, w = xw, yw, zw, 1.0 + xx + yy + zz
    square = w
    if 1.0 + xx - yy - zz > square:
        square = 1.0 + xx - yy - zz
        x, y, z, w = square, xy, xz, xw
    if 1.0 - xx + yy - zz > square:
        square = 1.0 - xx + yy - zz
        x, y, z, w = xy, square, yz, yw
    if 1.0 - xx - yy + zz > square:
        square = 1.0 - xx - yy + zz
        x, y, z, w = xz, yz, square, zw
    # At least 1 for every rotation; anything else has no quaternion.
    size = 2.0 * square_root(square) if square > 0.0 else square - square
    if w < 0.0:
        size = -size
    if size != 0.0:
        x, y, z, w = x / size, y / size, z / size, w / size
    result[0], result[1], result[2], result[3] = x, y, z, w
