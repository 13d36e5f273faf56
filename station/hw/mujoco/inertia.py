"""Combine mass properties of links that move as one body."""

from dataclasses import replace
from types import MappingProxyType

import mujoco
import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Inertial, JointType, Link, Pose, Urdf
from station.core.description.urdf_repair import Repair


def is_rigid_body(inertial: Inertial) -> bool:
    """Return whether a rigid body of positive volume can have these properties.

    A point mass (inertia 0) is not such a body. Neither is a body whose principal
    moments are not positive or violate the triangle inequality.
    """
    moments = principal_moments(inertial)
    return bool(moments[0] > 0.0 and moments[0] + moments[1] >= moments[2])


def principal_moments(inertial: Inertial) -> NDArray[np.float64]:
    """Return the principal moments of inertia [kg m^2], ascending, shape (3,)."""
    return np.asarray(np.linalg.eigvalsh(_tensor(inertial)), dtype=np.float64)


def carried_inertials(urdf: Urdf, link: Link) -> dict[str, tuple[Pose, Inertial]]:
    """Return the link's own inertia and those of point masses fixed to it.

    MuJoCo refuses a point mass as a body, so its mass is added to the body that carries
    it. A fixed link that is a point mass carries no other masses.

    Args:
        urdf: The robot.
        link: A link of the robot.

    Returns:
        By name of each link: its frame in the frame of `link`, and its inertia.
    """
    own = link.inertial
    above = urdf.joint_above(link.name)
    is_fixed = above is not None and above.type is JointType.FIXED
    if own is not None and is_fixed and not is_rigid_body(own):
        return {}
    parts = {} if own is None else {link.name: (Pose(), own)}
    frontier = [(link.name, Pose())]
    while frontier:
        name, pose = frontier.pop()
        for joint in urdf.joints_below(name):
            inertial = urdf.links[joint.child].inertial
            if joint.type is not JointType.FIXED:
                continue
            if inertial is None or not is_rigid_body(inertial):
                child_pose = pose.compose(joint.origin)
                frontier.append((joint.child, child_pose))
                if inertial is not None:
                    parts[joint.child] = (child_pose, inertial)
    return parts


def combine(parts: list[tuple[Pose, Inertial]]) -> Inertial:
    """Return the mass properties of bodies that are fixed to each other.

    Args:
        parts: For each body its link's frame in the common frame, and its properties;
            at least one.

    Returns:
        Properties in the common frame; the axes of `origin` are those of that frame.
    """
    placed = [(frame.compose(part.origin), part) for frame, part in parts]
    mass = sum(part.mass for _, part in placed)
    centre = np.zeros(3)
    for pose, part in placed:
        centre += np.array(pose.xyz) * part.mass / mass
    total = np.zeros((3, 3))
    for pose, part in placed:
        rotation = _rotation(pose)
        offset = np.array(pose.xyz) - centre
        steiner = offset @ offset * np.eye(3) - np.outer(offset, offset)
        total += rotation @ _tensor(part) @ rotation.T + part.mass * steiner
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = total.tolist()
    x, y, z = centre.tolist()
    return Inertial(mass, Pose((x, y, z)), (ixx, iyy, izz, ixy, ixz, iyz))


def _tensor(inertial: Inertial) -> NDArray[np.float64]:
    """Return the inertia in the axes of its origin [kg m^2], shape (3, 3)."""
    ixx, iyy, izz, ixy, ixz, iyz = inertial.inertia
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def _rotation(pose: Pose) -> NDArray[np.float64]:
    """Return the rotation matrix of a pose, shape (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array(pose.quaternion))
    return matrix.reshape(3, 3)


SMALL_MASS = 1e-3
"""Mass of a moving link that has none in the URDF [kg]."""
_RADIUS = 0.01
_SMALL_MOMENT = 0.4 * SMALL_MASS * _RADIUS**2
"""Moment of inertia of a ball of that mass, with a radius of 1 cm [kg m^2]."""
# MuJoCo's smallest mass and inertia of a body that moves, mjMINVAL.
_LEAST = 1e-15


def repair_inertias(urdf: Urdf) -> tuple[Urdf, tuple[Repair, ...]]:
    """Return the robot with a valid inertia for every moving link, and the repairs.

    Args:
        urdf: The robot; it is returned itself if there is nothing to repair.
    """
    changed: dict[str, Link] = {}
    repairs: list[Repair] = []
    for joint in urdf.joints.values():
        if not joint.type.moves:
            continue
        link = urdf.links[joint.child]
        parts = carried_inertials(urdf, link)
        if not parts:
            if not _has_body_below(urdf, link.name):
                changed[link.name] = replace(link, inertial=_small_ball())
                repairs.append(_tell_mass(link))
            continue
        whole = combine(list(parts.values()))
        moments = principal_moments(whole)
        if moments[0] > _LEAST and moments[0] + moments[1] >= moments[2]:
            continue
        balanced, repair = _balance(link, whole, moments)
        # This link now has the masses of the others.
        changed |= {n: replace(urdf.links[n], inertial=None) for n in parts}
        changed[link.name] = replace(link, inertial=balanced)
        repairs.append(repair)
    if not changed:
        return urdf, ()
    links = MappingProxyType({**urdf.links, **changed})
    return (
        Urdf(urdf.name, links, urdf.joints, urdf.root),
        tuple(repairs),
    )


def _balance(
    link: Link, whole: Inertial, moments: NDArray[np.float64]
) -> tuple[Inertial, Repair]:
    """Return equal moments of inertia for all that a link carries."""
    mean = float(np.mean(moments))
    if mean > _LEAST:
        problem = "no rigid body has its principal moments of inertia"
    else:
        mean = max(0.4 * whole.mass * _RADIUS**2, _SMALL_MOMENT)
        problem = "it moves and has no inertia"
    own = 0.0 if link.inertial is None else link.inertial.mass
    others = whole.mass - own
    old = " ".join(f"{moment:.4g}" for moment in moments.tolist())
    new = f"{mean:.4g} about every axis [kg m^2]"
    if others > 0.0:
        new += f", with {others:.4g} kg fixed to it"
    balanced = Inertial(whole.mass, whole.origin, (mean, mean, mean, 0.0, 0.0, 0.0))
    return balanced, Repair("inertia", f"link '{link.name}'", problem, old, new)


def _small_ball() -> Inertial:
    moment = _SMALL_MOMENT
    return Inertial(SMALL_MASS, Pose(), (moment, moment, moment, 0.0, 0.0, 0.0))


def _tell_mass(link: Link) -> Repair:
    new = f"{SMALL_MASS:g} kg and {_SMALL_MOMENT:.1g} kg m^2"
    return Repair("mass", f"link '{link.name}'", "it moves and has no mass", "0", new)


def _has_body_below(urdf: Urdf, link: str) -> bool:
    """Return whether a body with mass is fixed to a link without one."""
    frontier = [link]
    while frontier:
        name = frontier.pop()
        for joint in urdf.joints_below(name):
            if not joint.type.moves:
                if urdf.links[joint.child].inertial is not None:
                    return True
                frontier.append(joint.child)
    return False
