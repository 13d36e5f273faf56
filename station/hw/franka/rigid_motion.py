"""Poses, rotation vectors and twists in plain floats.

Poses have 16 numbers, flat and column-major; rotations are the upper left 3 x 3 of one.
"""

from collections.abc import Sequence
from math import acos, atan2, cos, isfinite, pi, sin, sqrt

from station.core.errors import InvalidCommandError

_UNIT_TOLERANCE = 1e-5
_SMALL = 1e-9


def transform_problem(pose: Sequence[float]) -> str:
    """Say why 16 numbers are no homogeneous transform; empty when they are one.

    Orthogonality and handedness are not tested.

    Args:
        pose: The numbers.

    Source:
        libfranka@0.9.2 src/control_tools.cpp, isHomogeneousTransformation.
    """
    if len(pose) != 16 or not isfinite(sum(pose)):
        return "it must be 16 finite numbers"
    if pose[3] or pose[7] or pose[11] or pose[15] != 1.0:
        return "its last row must be 0, 0, 0, 1"
    for i in range(3):
        column = sqrt(sum(pose[4 * i + k] ** 2 for k in range(3)))
        row = sqrt(sum(pose[4 * k + i] ** 2 for k in range(3)))
        if abs(column - 1.0) > _UNIT_TOLERANCE or abs(row - 1.0) > _UNIT_TOLERANCE:
            return "the rows and columns of its rotation must have length 1"
    return ""


def check_transform(pose: Sequence[float], what: str) -> list[float]:
    """Return the pose as a new list.

    Args:
        pose: The numbers.
        what: What it is, for the message.

    Raises:
        InvalidCommandError: It is no homogeneous transform.
    """
    problem = transform_problem(pose)
    if problem:
        raise InvalidCommandError(
            f"{what} {list(pose)} is no transform: {problem}",
            remedy="give a homogeneous transform, column by column",
            details={
                "errors": [
                    {"field": f"body/{what}", "message": problem, "value": str(pose)}
                ]
            },
        )
    return list(pose)


def rotation_between(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Return the rotation vector [rad], shape (3,), that turns one pose to another.

    It is in the axes in which both poses are given; its length is 0 to pi.

    Args:
        first: Pose to begin with.
        second: Pose to end with.
    """
    # R = R_second R_first^T
    r = [
        sum(second[4 * k + row] * first[4 * k + column] for k in range(3))
        for row in range(3)
        for column in range(3)
    ]
    x, y, z = r[7] - r[5], r[2] - r[6], r[3] - r[1]
    sine = sqrt(x * x + y * y + z * z) / 2.0
    cosine = (r[0] + r[4] + r[8] - 1.0) / 2.0
    if sine > _SMALL:
        scale = atan2(sine, cosine) / (2.0 * sine)
        return [scale * x, scale * y, scale * z]
    if cosine > 0.0:
        return [x / 2.0, y / 2.0, z / 2.0]
    diagonal = [sqrt(max(0.0, (r[4 * i] + 1.0) / 2.0)) for i in range(3)]
    largest = diagonal.index(max(diagonal))
    axis = [r[3 * largest + i] / (2.0 * diagonal[largest]) for i in range(3)]
    axis[largest] = diagonal[largest]
    angle = pi if cosine <= -1.0 else acos(cosine)
    return [angle * value for value in axis]


def displace(
    pose: Sequence[float], shift: Sequence[float], turn: Sequence[float]
) -> list[float]:
    """Return a pose moved by a shift and a rotation vector, in its outer axes.

    The rotation is made exactly orthonormal again.

    Args:
        pose: The pose.
        shift: Of the origin [m], shape (3,).
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
    """Make the rotation of a pose exact, keeping its x axis."""
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
        first: Pose to begin with.
        second: Pose to end with.
        period: Time between them [s], > 0.
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


def times(jacobian: Sequence[float], dq: Sequence[float]) -> list[float]:
    """Return J dq, shape (6,).

    Args:
        jacobian: 42 numbers, column-major.
        dq: Joint velocities, shape (7,).
    """
    result = [0.0] * 6
    for joint, rate in enumerate(dq):
        if rate:
            for row in range(6):
                result[row] += jacobian[6 * joint + row] * rate
    return result
