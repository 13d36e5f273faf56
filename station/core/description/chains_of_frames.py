"""Kinematic chains from the base of an arm to frames of its description."""

from collections.abc import Sequence
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Joint, JointType, Pose, Urdf
from station.core.errors import ControllerLoadError
from station.core.numerics.arm_chain import JointChain


def chain_to(urdf: Urdf, base: str, frame: str, joints: Sequence[str]) -> JointChain:
    """Return the chain from one link to another.

    Args:
        urdf: The robot.
        base: Link at which the chain begins; `frame` is below this link, or below a
            link that carries this link by fixed joints only.
        frame: Link at the end of the chain.
        joints: The joints whose positions the caller gives, in their order.

    Raises:
        ControllerLoadError: A link is unknown, no chain leads from one link to the
            other, or a joint in it is not among `joints`.
    """
    for link in (base, frame):
        if link not in urdf.links:
            _refuse(f"The robot has no link '{link}'.")
    # The links that carry the base by fixed joints, and the pose of each in the base.
    carriers, pose, link = {base: np.eye(4)}, np.eye(4), base
    while (above := urdf.joint_above(link)) and above.type is JointType.FIXED:
        pose = pose @ np.linalg.inv(_matrix(above.origin))
        link = above.parent
        carriers[link] = pose
    path: list[Joint] = []
    link = frame
    while link not in carriers:
        above = urdf.joint_above(link)
        if above is None:
            _refuse(f"Link '{frame}' is not below '{base}'.")
        path.insert(0, above)
        link = above.parent
    origins = [carriers[link]]
    moving: list[Joint] = []
    for joint in path:
        origins[-1] = origins[-1] @ _matrix(joint.origin)
        if joint.type is JointType.FIXED:
            continue
        if joint.name not in joints:
            _refuse(
                f"Joint '{joint.name}' between '{base}' and '{frame}' is none of the "
                "controller's."
            )
        moving.append(joint)
        origins.append(np.eye(4))
    return JointChain(
        len(joints),
        np.concatenate([origin.T.ravel() for origin in origins]).tolist(),
        [part for joint in moving for part in joint.axis],
        [float(joint.type.is_rotation) for joint in moving],
        [joints.index(joint.name) for joint in moving],
    )


def ends_of_chain(urdf: Urdf, joints: Sequence[str]) -> tuple[str, str]:
    """Return the links at both ends of a chain of joints: its base and its tip.

    The tip is the last link that is fixed below the last joint. If there are several,
    it is the link that is called `tool0`, as in ROS-Industrial.

    Args:
        urdf: The robot.
        joints: The joints, in any order.

    Raises:
        ControllerLoadError: The joints form no chain, or several links could be
            the tip.
    """
    moved = [urdf.joints[name] for name in joints if name in urdf.joints]
    carried = {joint.name: _joints_above(urdf, joint) for joint in moved}
    last = max(carried, key=lambda name: len(carried[name]), default="")
    chain = [joint for joint in carried.get(last, ()) if joint.name in joints]
    if len(chain) < len(joints):
        _refuse("The joints of the controller form no chain.")
    ends, waiting = [], [chain[0].child]
    while waiting:
        link = waiting.pop()
        fixed = [j for j in urdf.joints_below(link) if j.type is JointType.FIXED]
        waiting += [joint.child for joint in fixed]
        ends += [] if fixed else [link]
    tips = [link for link in ends if link.endswith("tool0")] or ends
    if len(tips) > 1:
        _refuse(f"The tip of the arm may be {' or '.join(sorted(tips))}.")
    return chain[-1].parent, tips[0]


def _joints_above(urdf: Urdf, joint: Joint) -> list[Joint]:
    """Return a joint and all joints that carry it, towards the root."""
    found = [joint]
    while (above := urdf.joint_above(found[-1].parent)) is not None:
        found.append(above)
    return found


def _refuse(problem: str) -> NoReturn:
    raise ControllerLoadError(
        problem, remedy="Correct `kinematics`, `joints` or the name of the frame."
    )


def _matrix(pose: Pose) -> NDArray[np.float64]:
    """Return a pose as a matrix, shape (4, 4)."""
    w, x, y, z = pose.quaternion
    result = np.eye(4)
    result[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    result[:3, 3] = pose.xyz
    return result
