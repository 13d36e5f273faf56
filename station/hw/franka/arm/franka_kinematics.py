"""Poses and Jacobians of the arm's frames, in plain floats.

All matrices are flat and column-major, as libfranka has them: a pose T has 16 numbers,
T(r, c) = T[4 c + r]; a Jacobian has 42, J(r, c) = J[6 c + r], rows vx vy vz wx wy wz.
Base frame O: centre of the base, z along joint 1.

Source: Franka Control Interface documentation, Denavit-Hartenberg parameters (Craig's
convention; the same for Panda and FR3); libfranka@0.9.2 include/franka/model.h, Frame.
"""

# ruff: noqa: N803 - F_T_EE and EE_T_K are libfranka's names.

from collections.abc import Sequence
from math import cos, pi, sin

from station.core.franka.franka_model import Frame

_DOF = 7
# (a [m], d [m], alpha [rad]) of joints 1 to 7, then the flange.
_DH = (
    (0.0, 0.333, 0.0),
    (0.0, 0.0, -pi / 2),
    (0.0, 0.316, pi / 2),
    (0.0825, 0.0, pi / 2),
    (-0.0825, 0.384, -pi / 2),
    (0.0, 0.0, pi / 2),
    (0.088, 0.0, pi / 2),
    (0.0, 0.107, 0.0),
)
_DH_TRIGONOMETRY = tuple((a, d, cos(alpha), sin(alpha)) for a, d, alpha in _DH)

IDENTITY = (
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
    0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
)  # fmt: skip
"""The pose of a frame in itself."""


def compose(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Return T_a_c of the poses T_a_b and T_b_c, each with 16 numbers."""
    a, b, c, d, e, f, g, h, i, j, k, m, x, y, z, w = first
    result = []
    for column in (0, 4, 8, 12):
        p, q, r, s = second[column : column + 4]
        result += [
            a * p + e * q + i * r + x * s,
            b * p + f * q + j * r + y * s,
            c * p + g * q + k * r + z * s,
            d * p + h * q + m * r + w * s,
        ]
    return result


def frame_pose(
    frame: Frame,
    q: Sequence[float],
    F_T_EE: Sequence[float] = IDENTITY,
    EE_T_K: Sequence[float] = IDENTITY,
) -> list[float]:
    """Return the pose of a frame in the base frame, 16 numbers.

    Args:
        frame: The frame.
        q: Joint positions [rad], shape (7,).
        F_T_EE: End effector in the flange frame, 16 numbers.
        EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
    """
    return _pose_of(frame, link_poses(q), F_T_EE, EE_T_K)


def zero_jacobian(
    frame: Frame,
    q: Sequence[float],
    F_T_EE: Sequence[float] = IDENTITY,
    EE_T_K: Sequence[float] = IDENTITY,
) -> list[float]:
    """Return the Jacobian of a frame's origin in the axes of the base, 42 numbers.

    Args:
        frame: The frame; columns of joints behind it are zero.
        q: Joint positions [rad], shape (7,).
        F_T_EE: End effector in the flange frame, 16 numbers.
        EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
    """
    poses = link_poses(q)
    return _jacobian(frame, poses, _pose_of(frame, poses, F_T_EE, EE_T_K))


def pose_and_jacobian(
    q: Sequence[float], F_T_EE: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Return `frame_pose` and `zero_jacobian` of the end effector.

    Args:
        q: Joint positions [rad], shape (7,).
        F_T_EE: End effector in the flange frame, 16 numbers.
    """
    poses, frame = link_poses(q), Frame.END_EFFECTOR
    pose = _pose_of(frame, poses, F_T_EE, IDENTITY)
    return pose, _jacobian(frame, poses, pose)


def body_jacobian(
    frame: Frame,
    q: Sequence[float],
    F_T_EE: Sequence[float] = IDENTITY,
    EE_T_K: Sequence[float] = IDENTITY,
) -> list[float]:
    """Return the Jacobian of a frame's origin in the frame's own axes, 42 numbers.

    Args:
        frame: The frame; columns of joints behind it are zero.
        q: Joint positions [rad], shape (7,).
        F_T_EE: End effector in the flange frame, 16 numbers.
        EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
    """
    poses = link_poses(q)
    pose = _pose_of(frame, poses, F_T_EE, EE_T_K)
    jacobian = _jacobian(frame, poses, pose)
    result = []
    for start in range(0, 6 * _DOF, 3):
        x, y, z = jacobian[start : start + 3]
        result += [
            pose[column] * x + pose[column + 1] * y + pose[column + 2] * z
            for column in (0, 4, 8)
        ]
    return result


def link_poses(q: Sequence[float]) -> list[list[float]]:
    """Return the poses of the links 1 to 7 and the flange in the base frame.

    Written out by elements, because this runs in every cycle of a Cartesian controller.
    """
    poses = []
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    px = py = pz = 0.0
    for (a, d, ca, sa), theta in zip(_DH_TRIGONOMETRY, [*q, 0.0], strict=True):
        # The y and z axes turned by alpha about x, the origin moved along x and z.
        ux, uy, uz = ca * yx + sa * zx, ca * yy + sa * zy, ca * yz + sa * zz
        zx, zy, zz = ca * zx - sa * yx, ca * zy - sa * yy, ca * zz - sa * yz
        px, py, pz = px + a * xx + d * zx, py + a * xy + d * zy, pz + a * xz + d * zz
        # Then all turned by theta about z.
        ct, st = cos(theta), sin(theta)
        vx, vy, vz = ct * xx + st * ux, ct * xy + st * uy, ct * xz + st * uz
        yx, yy, yz = ct * ux - st * xx, ct * uy - st * xy, ct * uz - st * xz
        xx, xy, xz = vx, vy, vz
        poses.append([
            xx, xy, xz, 0.0, yx, yy, yz, 0.0, zx, zy, zz, 0.0, px, py, pz, 1.0,
        ])  # fmt: skip
    return poses


def _pose_of(
    frame: Frame,
    poses: Sequence[list[float]],
    F_T_EE: Sequence[float],
    EE_T_K: Sequence[float],
) -> list[float]:
    if frame.value <= Frame.FLANGE.value:
        return poses[frame.value]
    pose = compose(poses[Frame.FLANGE.value], F_T_EE)
    return pose if frame is Frame.END_EFFECTOR else compose(pose, EE_T_K)


def _jacobian(
    frame: Frame, poses: Sequence[list[float]], pose: Sequence[float]
) -> list[float]:
    px, py, pz = pose[12:15]
    result = [0.0] * (6 * _DOF)
    for joint in range(min(frame.value + 1, _DOF)):
        link = poses[joint]
        ax, ay, az = link[8:11]
        x, y, z = px - link[12], py - link[13], pz - link[14]
        result[6 * joint : 6 * joint + 6] = [
            ay * z - az * y, az * x - ax * z, ax * y - ay * x, ax, ay, az,
        ]  # fmt: skip
    return result
