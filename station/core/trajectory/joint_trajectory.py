"""A requested trajectory: points in time for named joints.

Source: trajectory_msgs/JointTrajectory.msg; ros_controllers@678b92a
joint_trajectory_controller/joint_trajectory_msg_utils.h.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite

from station.core.errors import InvalidTrajectoryError
from station.core.trajectory.ros_time import to_nanoseconds


@dataclass(frozen=True, slots=True)
class JointTrajectoryPoint:
    """Desired state of the joints at one time; lists have the order of `joint_names`.

    Attributes:
        positions: Positions [rad or m].
        velocities: Velocities [rad/s or m/s]; empty if not specified.
        accelerations: Accelerations [rad/s^2 or m/s^2]; empty if not specified.
        time_from_start: Time from the start of the trajectory [s].
    """

    positions: Sequence[float]
    velocities: Sequence[float] = ()
    accelerations: Sequence[float] = ()
    time_from_start: float = 0.0


@dataclass(frozen=True, slots=True)
class JointTrajectory:
    """Points that the joints pass through.

    Attributes:
        joint_names: Names of the joints.
        points: The points in the order of time; without points, the joints stop and
            hold their positions.
        stamp: Station time at which the trajectory starts [s]; 0 means now.
    """

    joint_names: Sequence[str]
    points: Sequence[JointTrajectoryPoint]
    stamp: float = 0.0

    def start_nanoseconds(self, now: int) -> int:
        """Return the time at which the trajectory starts [ns].

        Args:
            now: The present time [ns].
        """
        stamp = to_nanoseconds(self.stamp)
        return now if stamp == 0 else stamp

    def is_due_at_once(self) -> bool:
        """Return whether it is a single point at its start, which is now."""
        return self.stamp == 0.0 and self.points[-1].time_from_start == 0.0

    def first_not_later(self) -> int | None:
        """Return the index of the first point that is not later than the one before.

        None if there is none.
        """
        times = [to_nanoseconds(point.time_from_start) for point in self.points]
        for index, (before, time) in enumerate(pairwise(times), start=1):
            if time <= before:
                return index
        return None

    def last_point_before(self, now: int) -> int | None:
        """Return the index of the last point at or before `now` [ns]; None if none."""
        start = self.start_nanoseconds(now)
        found = None
        for index, point in enumerate(self.points):
            if start + to_nanoseconds(point.time_from_start) > now:
                break
            found = index
        return found

    def check_values(self) -> None:
        """Refuse points that do not fit the joints or are not finite.

        Raises:
            InvalidTrajectoryError: A point has the wrong number of positions,
                velocities or accelerations, or a number is not finite.
        """
        if not isfinite(self.stamp):
            raise InvalidTrajectoryError(
                f"The trajectory has the stamp {self.stamp}; it must be finite.",
                remedy="Give a finite time.",
            )
        for index, point in enumerate(self.points):
            self._check_point(index, point)

    def _check_point(self, index: int, point: JointTrajectoryPoint) -> None:
        size = len(self.joint_names)
        columns = {
            "positions": point.positions,
            "velocities": point.velocities,
            "accelerations": point.accelerations,
        }
        for what, values in columns.items():
            if len(values) != size and (values or what == "positions"):
                raise InvalidTrajectoryError(
                    f"Point {index} has {len(values)} {what} for {size} joints.",
                    remedy=f"Give {size} {what}, in the order of joint_names.",
                    details={"point": index, "reason": "size"},
                )
            for name, value in zip(self.joint_names, values, strict=False):
                if not isfinite(value):
                    raise InvalidTrajectoryError(
                        f"Point {index} has {value} among its {what}, for '{name}'; "
                        "it must be finite.",
                        remedy="Give finite numbers.",
                        details={"point": index, "joint": name, "reason": "finite"},
                    )
        if not isfinite(point.time_from_start):
            raise InvalidTrajectoryError(
                f"Point {index} has the time_from_start {point.time_from_start}; it "
                "must be finite.",
                remedy="Give a finite time.",
                details={"point": index, "reason": "finite"},
            )
