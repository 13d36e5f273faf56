"""Compute the frame of a joint from the position of the joint.

A robot is drawn once, as nested frames. After that, only the frames of moving joints
get a new pose, which takes an eighth of the time that all link poses would take.
"""

import math
from collections.abc import Mapping

from station.core.description.urdf import Joint, JointType, Pose, Urdf


def is_drawn_moving(joint: Joint) -> bool:
    """Return whether the dashboard moves this joint: a joint with a single axis."""
    return joint.type.is_rotation or joint.type is JointType.PRISMATIC


def position_among(joint: Joint, positions: Mapping[str, float]) -> float | None:
    """Return a joint's position [rad] or [m], or None if it is not known.

    A measured position takes precedence over the rule of a mimic joint.

    Args:
        joint: The joint.
        positions: Measured positions by joint [rad] or [m].
    """
    own = positions.get(joint.name)
    if own is not None or joint.mimic is None:
        return own
    source = positions.get(joint.mimic.joint)
    if source is None:
        return None
    return joint.mimic.multiplier * source + joint.mimic.offset


def pose_at(joint: Joint, q: float) -> Pose:
    """Return the pose of a joint's child link in its parent link.

    Args:
        joint: The joint.
        q: Position of the joint [rad] or [m]; not used for a fixed joint.
    """
    if joint.type.is_rotation:
        half = 0.5 * q
        x, y, z = (math.sin(half) * part for part in joint.axis)
        return joint.origin.compose(Pose(quaternion=(math.cos(half), x, y, z)))
    if joint.type is JointType.PRISMATIC:
        x, y, z = (q * part for part in joint.axis)
        return joint.origin.compose(Pose((x, y, z)))
    return joint.origin


def link_poses(urdf: Urdf, positions: Mapping[str, float]) -> dict[str, Pose]:
    """Return the pose of every link in the root link.

    Args:
        urdf: The robot.
        positions: Joint positions by name [rad] or [m]; a joint without a position is
            drawn at zero, as at the start.
    """
    poses = {urdf.root: Pose()}
    waiting = [urdf.root]
    while waiting:
        parent = waiting.pop()
        for joint in urdf.joints_below(parent):
            q = position_among(joint, positions) or 0.0
            poses[joint.child] = poses[parent].compose(pose_at(joint, q))
            waiting.append(joint.child)
    return poses


def link_path(urdf: Urdf, link: str, root: str) -> str:
    """Return the scene node of a link, below those of the links that carry it.

    Args:
        urdf: The robot.
        link: The link.
        root: Scene node of the robot's root link.
    """
    path = []
    while (joint := urdf.joint_above(link)) is not None:
        path.append(link)
        link = joint.parent
    return "/".join([root, *reversed(path)])
