"""Refuse trajectories that end too late, lead beyond limits, or are too fast."""

from collections.abc import Sequence

from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import JointTrajectory, JointTrajectorySegment

MAX_DURATION = 86_400.0
"""Latest end of a trajectory from now, and longest goal time tolerance [s]: a day."""
_ROUNDING = 1e-6
"""Relative excess that rounding may cause."""
_PEAK_RATIO = 2.0
"""Largest peak over mean velocity; a quintic spline from rest to rest has 1.875."""
_SAMPLES = 5
"""Number of times in a segment at which its velocity is checked."""


def check_duration(request: JointTrajectory, now: float) -> None:
    """Refuse points that are due more than `MAX_DURATION` from now.

    Times that long come from a wrong unit, such as nanoseconds.

    Args:
        request: The trajectory.
        now: Station time [s].

    Raises:
        InvalidTrajectoryError: A point is due later than that.
    """
    ahead = request.stamp - now if request.stamp else 0.0
    for index, point in enumerate(request.points):
        due = ahead + point.time_from_start
        if due > MAX_DURATION:
            raise InvalidTrajectoryError(
                f"Point {index} is due in {due:.6g} s; allowed are {MAX_DURATION:g} s.",
                remedy="Give times in seconds, not in nanoseconds.",
                details={"point": index, "reason": "duration", "due": due},
            )


def check_positions(
    request: JointTrajectory, joints: Sequence[JointDescription]
) -> None:
    """Refuse positions beyond the limits of a joint.

    Args:
        request: The trajectory; every point has one position for each of its joints.
        joints: The joints of the controller.

    Raises:
        InvalidTrajectoryError: A position is beyond the joint's limits.
    """
    known = {joint.name: joint for joint in joints}
    for column, name in enumerate(request.joint_names):
        joint = known[name]
        for index, point in enumerate(request.points):
            position = point.positions[column]
            if not joint.lower <= position <= joint.upper:
                raise InvalidTrajectoryError(
                    f"Point {index} has the position {position} for '{name}'; "
                    f"allowed is {joint.lower} to {joint.upper}.",
                    remedy="Give positions within the limits of the joint.",
                    details={"point": index, "joint": name, "reason": "limits"},
                )


def check_segment_velocity(
    joint: JointDescription, segment: JointTrajectorySegment
) -> None:
    """Refuse a segment whose mean or last velocity exceeds the limit of its joint.

    Between its ends a segment may be faster than the limit, because a motion from rest
    to rest peaks above its mean velocity; the joint limits of the hardware bound that
    peak. A velocity above `_PEAK_RATIO` times the limit is refused, because only wrong
    velocities or accelerations of the points lead to it.

    Args:
        joint: The joint; unlimited when its description has no velocity limit.
        segment: The motion from one point to the next.

    Raises:
        InvalidTrajectoryError: The segment is too fast; `details["reason"]` is `pace`.
    """
    duration = segment.end_time - segment.start_time
    start = segment.spline.sample_dimension(segment.start_time)[0]
    distance = segment.end.position[0] - start
    unit = "m" if joint.is_linear() else "rad"
    if abs(distance) <= joint.velocity * duration * (1.0 + _ROUNDING):
        _check_velocities(joint, segment, unit)
        return
    raise InvalidTrajectoryError(
        f"Joint '{joint.name}' would have to move {distance:.6g} {unit} in "
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
        peak = 1.0 if sample == _SAMPLES else _PEAK_RATIO
        # `not <=` instead of `>`: NaN compares false, and is refused like this.
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
