"""Take joint limits over from a robot description.

Source: ros_control@633c374 joint_limits_urdf.h.
"""

from dataclasses import replace

from station.core.description.urdf import Joint, JointType
from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits


def joint_limits_from_urdf(
    joint: Joint, limits: JointLimits | None = None
) -> JointLimits | None:
    """Return a joint's limits from its `<limit>` element.

    The URDF wins over earlier limits; it removes those of acceleration, and keeps those
    of jerk.

    Args:
        joint: The joint of the robot description.
        limits: Earlier limits to be completed; None if there are none.

    Returns:
        The limits, or None if the joint has no `<limit>`.
    """
    if joint.limit is None:
        return None
    earlier = limits or JointLimits()
    return replace(
        earlier,
        min_position=joint.limit.lower,
        max_position=joint.limit.upper,
        max_velocity=joint.limit.velocity,
        # As in ros_control, a URDF states none, and an earlier one is forgotten.
        max_acceleration=None,
        max_effort=joint.limit.effort,
        angle_wraparound=(
            earlier.angle_wraparound or joint.type is JointType.CONTINUOUS
        ),
    )


def soft_joint_limits_from_urdf(joint: Joint) -> SoftJointLimits | None:
    """Return a joint's soft limits from its `<safety_controller>` element.

    Args:
        joint: The joint of the robot description.

    Returns:
        The soft limits, or None if the joint has no `<safety_controller>`.
    """
    safety = joint.safety
    if safety is None:
        return None
    return SoftJointLimits(
        min_position=safety.soft_lower_limit,
        max_position=safety.soft_upper_limit,
        k_position=safety.k_position,
        k_velocity=safety.k_velocity,
    )
