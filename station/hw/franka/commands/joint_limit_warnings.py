"""Warnings of joints that are close to a position limit.

Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, FrankaHW::checkJointLimits.
"""

from collections.abc import Sequence
from math import degrees

from station.core.description.urdf import Joint


def joint_limit_warnings(
    joints: Sequence[Joint], q: Sequence[float], threshold: float
) -> list[str]:
    """Return one sentence per joint that is close to a position limit.

    Args:
        joints: The joints of the URDF, n of them.
        q: Their positions [rad], shape (n,).
        threshold: Distance to a limit below which there is a warning [rad], >= 0.
    """
    warnings = []
    for joint, position in zip(joints, q, strict=True):
        limit = joint.limit
        if limit is None or limit.lower is None or limit.upper is None:
            continue
        distance = min(abs(position - limit.lower), abs(position - limit.upper))
        if distance < threshold:
            warnings.append(
                f"{joint.name} is {degrees(distance):.1f} degrees from a limit"
            )
    return warnings
