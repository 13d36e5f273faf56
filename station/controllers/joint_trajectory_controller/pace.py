"""Is a way too fast for a joint?"""

from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import JointTrajectorySegment

_ROUNDING = 1e-6
_PEAK = 2.0
"""Fastest over mean velocity; a quintic spline from rest to rest has 1.875."""
_SAMPLES = 5


def check_pace(joint: JointDescription, segment: JointTrajectorySegment) -> None:
    """Refuse a segment whose mean or last velocity is more than the joint's limit.

    The velocity in between may be higher, as it is on the way from rest to rest; that
    is for the limits of the hardware. It may not be so high that no such way needs it:
    then the velocities or accelerations of the points are no good.

    Args:
        joint: The joint; unlimited when its description has no velocity limit.
        segment: A way from one point to the next.

    Raises:
        InvalidTrajectoryError: It is too fast; `details["reason"]` is `pace`.
    """
    duration = segment.end_time - segment.start_time
    start = segment.spline.sample_dimension(segment.start_time)[0]
    distance = segment.end.position[0] - start
    unit = "m" if joint.is_linear() else "rad"
    if abs(distance) <= joint.velocity * duration * (1.0 + _ROUNDING):
        _check_velocities(joint, segment, unit)
        return
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


def _check_velocities(
    joint: JointDescription, segment: JointTrajectorySegment, unit: str
) -> None:
    duration = segment.end_time - segment.start_time
    for sample in range(1, _SAMPLES + 1):
        time = segment.start_time + duration * sample / _SAMPLES
        velocity = segment.spline.sample_dimension(time)[1]
        peak = 1.0 if sample == _SAMPLES else _PEAK
        # Not `>`: a velocity that is no number is refused, too.
        if not abs(velocity) <= peak * joint.velocity * (1.0 + _ROUNDING):
            raise InvalidTrajectoryError(
                f"Joint '{joint.name}' would move with {velocity:.6g} {unit}/s on its "
                f"way to {segment.end.position[0]:.6g} {unit}; its limit is "
                f"{joint.velocity:.6g} {unit}/s.",
                remedy="Correct the velocities and accelerations of the points.",
                details={
                    "reason": "pace",
                    "joint": joint.name,
                    "velocity": velocity,
                    "velocity_limit": joint.velocity,
                },
            )
