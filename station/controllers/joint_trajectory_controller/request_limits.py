"""Can the joints reach what is requested, and is its end in sight?"""

from collections.abc import Sequence

from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import JointTrajectory

MAX_DURATION = 86_400.0
"""How far ahead a trajectory may end, and how long a goal may be late [s]: a day."""


def check_duration(request: JointTrajectory, now: float) -> None:
    """Refuse points that are due so late that nobody can mean it.

    Args:
        request: The trajectory.
        now: Station time [s].

    Raises:
        InvalidTrajectoryError: A point is due more than `MAX_DURATION` from now.
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
    """Refuse positions that a joint cannot reach.

    Args:
        request: The trajectory, with one position for each of its joints in a point.
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
