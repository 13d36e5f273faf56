"""Is a way too fast for a joint?"""

from station.core.errors import InvalidTrajectoryError
from station.core.robot_description import JointDescription
from station.core.trajectory import JointTrajectorySegment

_ROUNDING = 1e-6


def check_pace(joint: JointDescription, segment: JointTrajectorySegment) -> None:
    """Refuse a segment whose mean velocity is more than the joint's limit.

    The velocity in between may be higher; that is for the limits of the hardware.

    Args:
        joint: The joint; unlimited when its description has no velocity limit.
        segment: A way from one point to the next.

    Raises:
        InvalidTrajectoryError: It is too fast; `details["reason"]` is `pace`.
    """
    duration = segment.end_time - segment.start_time
    start = segment.spline.sample_dimension(segment.start_time)[0]
    distance = segment.end.position[0] - start
    if abs(distance) <= joint.velocity * duration * (1.0 + _ROUNDING):
        return
    unit = "m" if joint.is_linear() else "rad"
    raise InvalidTrajectoryError(
        f"Joint '{joint.name}' would have to go {distance:.6g} {unit} in "
        f"{duration:.6g} s on its way to {segment.end.position[0]:.6g} {unit}; its "
        f"limit is {joint.velocity:.6g} {unit}/s.",
        remedy="Start the trajectory where the joints are, or give it more time.",
        details={
            "reason": "pace",
            "joint": joint.name,
            "distance": distance,
            "duration": duration,
            "velocity_limit": joint.velocity,
        },
    )
