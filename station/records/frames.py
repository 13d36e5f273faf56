"""The poses of a robot's links in each other, for viewers that draw it."""

from collections.abc import Mapping
from math import cos, sin

from station.core.description.urdf import Joint, JointType, Pose, Urdf
from station.records.cdr import Values
from station.records.messages import header


def joint_pose(joint: Joint, position: float) -> Pose:
    """Return the pose of a joint's child in its parent.

    Args:
        joint: The joint.
        position: Its position [rad or m]; joints without one stay at their origin.
    """
    if joint.type.is_rotation:
        half = position / 2.0
        x, y, z = (sin(half) * axis for axis in joint.axis)
        return joint.origin.compose(Pose(quaternion=(cos(half), x, y, z)))
    if joint.type is JointType.PRISMATIC:
        x, y, z = (position * axis for axis in joint.axis)
        return joint.origin.compose(Pose((x, y, z)))
    return joint.origin


def transforms(urdf: Urdf, positions: Mapping[str, float], stamp: int) -> Values:
    """Return a `tf2_msgs/TFMessage` with a transform for every joint.

    Args:
        urdf: The robot.
        positions: Positions by joint [rad or m]; others are at zero, and those that
            mimic another joint follow it.
        stamp: Time of the transforms [ns].
    """
    return {
        "transforms": [
            _transform(joint, joint_pose(joint, _position(joint, positions)), stamp)
            for joint in urdf.joints.values()
        ]
    }


def _position(joint: Joint, positions: Mapping[str, float]) -> float:
    if joint.name in positions:
        return positions[joint.name]
    # A joint that mimics another one is no joint of the robot's state.
    mimic = joint.mimic
    if mimic is None:
        return 0.0
    return mimic.multiplier * positions.get(mimic.joint, 0.0) + mimic.offset


def _transform(joint: Joint, pose: Pose, stamp: int) -> Values:
    x, y, z = pose.xyz
    qw, qx, qy, qz = pose.quaternion
    return {
        "header": header(stamp, joint.parent),
        "child_frame_id": joint.child,
        "transform": {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
        },
    }
