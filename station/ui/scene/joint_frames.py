"""Frames of joints: computed from the positions, and moved in a Viser scene.

A robot is drawn once, as nested frames. After that, only the frames of moving joints
get a new pose, which takes an eighth of the time that all link poses would take.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import viser

from station.core.description.urdf import Joint, JointType, Pose, Urdf

Place = viser.ViserServer | viser.ClientHandle
"""All browsers, or one."""
_SMALLEST_STEP = 1e-4


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


@dataclass(frozen=True, slots=True)
class MovingFrame:
    """The frame of a link and the joint that moves it."""

    joint: Joint
    handle: viser.FrameHandle


class MovingFrames:
    """Moves the frames of one robot. To be used from Viser's event loop only.

    Args:
        place: Node of the scene that has the frames.
        frames: The frames.

    Attributes:
        frames: The frames.
        shown: The positions that are drawn, by joint [rad] or [m].
    """

    def __init__(self, place: Place, frames: list[MovingFrame]) -> None:
        self._place = place
        self.frames = frames
        self.shown: dict[str, float] = {}

    def show(self, positions: Mapping[str, float]) -> None:
        """Move the joints.

        Args:
            positions: Joint positions by name [rad] or [m]; a joint without a position
                stays as it is, and unknown names are skipped.
        """
        with self._place.atomic():
            for frame in self.frames:
                q = position_among(frame.joint, positions)
                name = frame.joint.name
                if q is None or abs(q - self.shown.get(name, 9e9)) < _SMALLEST_STEP:
                    continue
                self.shown[name] = q
                pose = pose_at(frame.joint, q)
                # Viser sends every assignment, so the constant part is not assigned.
                if frame.joint.type.is_rotation:
                    frame.handle.wxyz = pose.quaternion
                else:
                    frame.handle.position = pose.xyz
