"""Poses and Jacobians of the arm's frames, as lists of floats.

All matrices are flat and column-major, as libfranka has them: a pose T has 16 numbers,
T(r, c) = T[4 c + r]; a Jacobian has 42, J(r, c) = J[6 c + r], rows vx vy vz wx wy wz.
Base frame O: centre of the base, z along joint 1. `core.numerics.arm_chain` does the
arithmetic; code that runs in every cycle calls it with its own memory.

Source: Franka Control Interface documentation, Denavit-Hartenberg parameters (Craig's
convention; the same for Panda and FR3); libfranka@0.9.2 include/franka/model.h, Frame.
"""

# ruff: noqa: N803 - F_T_EE and EE_T_K are libfranka's names.

from collections.abc import Sequence
from math import cos, pi, sin

from station.core.franka.franka_model import Frame
from station.core.numerics import arm_chain, rigid_motion
from station.memory.doubles import Doubles, Storage, doubles, put, viewed, zeros

DOF = 7
"""Number of joints."""
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
CHAIN = doubles(
    value for a, d, alpha in _DH for value in (a, d, cos(alpha), sin(alpha))
)
"""The joints and the flange in the form of `station.core.numerics.arm_chain`."""
FLANGE_OFFSET = _DH[-1][1]
"""Distance of the flange from the frame of link 7, along z [m]."""

IDENTITY = (
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
    0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
)  # fmt: skip
"""The pose of a frame in itself."""


def compose(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Return T_a_c of the poses T_a_b and T_b_c, each with 16 numbers."""
    result = zeros(16)
    rigid_motion.compose(doubles(first), doubles(second), result)
    return [*result]


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
    return [*place_frame(frame, _placed(q), F_T_EE, EE_T_K)]


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
    links = _placed(q)
    return [*place_jacobian(frame, links, place_frame(frame, links, F_T_EE, EE_T_K))]


def place_frame(
    frame: Frame, links: Storage, F_T_EE: Sequence[float], EE_T_K: Sequence[float]
) -> Doubles:
    """Return the pose of a frame in the base frame, 16 numbers.

    Args:
        frame: The frame.
        links: Poses of the links 1 to 7 and the flange.
        F_T_EE: End effector in the flange frame, 16 numbers.
        EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
    """
    result = zeros(16)
    index = frame.index
    start = 16 * (index if index < DOF else DOF)
    pose = links[start : start + 16]
    if index <= DOF:
        put(result, pose)
        return result
    rigid_motion.compose(pose, viewed(F_T_EE), result)
    if frame is Frame.STIFFNESS:
        rigid_motion.compose(result, viewed(EE_T_K), result)
    return result


def place_jacobian(frame: Frame, links: Storage, pose: Doubles) -> Doubles:
    """Return the Jacobian of a frame's origin in the axes of the base, 42 numbers.

    Args:
        frame: The frame; columns of joints behind it are zero.
        links: Poses of the links 1 to 7 and the flange.
        pose: Pose of the frame in the base frame, 16 numbers.
    """
    result = zeros(6 * DOF)
    joints = min(frame.index + 1, DOF)
    arm_chain.zero_jacobian(links, pose, result[: 6 * joints])
    return result


def _placed(q: Sequence[float]) -> Doubles:
    links = arm_chain.new_links(CHAIN)
    arm_chain.place_links(CHAIN, viewed(q), links)
    return links
