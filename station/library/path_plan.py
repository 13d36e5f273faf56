"""Plan a trajectory goal along a waypoint path, and check it against joint limits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from station.core.errors import InvalidTrajectoryError, show
from station.core.hardware.limits import JointLimits
from station.core.trajectory import PosVelAccState, peak_speeds, through_waypoints
from station.reports import Waypoint, WaypointPath

_SHORTEST = 0.1
"""Shortest time to the next waypoint, e.g. when a path is resumed between two [s]."""


@dataclass(frozen=True, slots=True)
class PathPlan:
    """The motion of joints along the waypoints of a path.

    Attributes:
        path: Name of the path.
        joints: The joints, n of them.
        start: Present positions [rad or m], shape (n,).
        waypoints: The waypoints, k of them.
        states: Positions, velocities and accelerations at the waypoints, k of them.
    """

    path: str
    joints: Sequence[str]
    start: Sequence[float]
    waypoints: Sequence[Waypoint]
    states: Sequence[PosVelAccState]

    @property
    def times(self) -> list[float]:
        """Return the times at which the joints pass each waypoint [s], shape (k,)."""
        return [state.time_from_start for state in self.states]

    def goal(self) -> dict[str, object]:
        """Return the goal of a trajectory controller."""
        points = [
            {
                "positions": state.position,
                "velocities": state.velocity,
                "accelerations": state.acceleration,
                "time_from_start": state.time_from_start,
            }
            for state in self.states
        ]
        return {"trajectory": {"joint_names": list(self.joints), "points": points}}

    def check(self, limits: Mapping[str, JointLimits]) -> None:
        """Refuse a path that the limits of the joints do not allow.

        Args:
            limits: Limits by the name of the joint.

        Raises:
            InvalidTrajectoryError: A waypoint is out of a joint's range, or the way to
                it is too fast for a joint.
        """
        peaks = peak_speeds(self.start, self.states)
        for waypoint, state, speeds in zip(
            self.waypoints, self.states, peaks, strict=True
        ):
            for joint, q, speed in zip(
                self.joints, state.position, speeds, strict=True
            ):
                if joint in limits:
                    self._check_joint(waypoint, joint, q, speed, limits[joint])

    def _check_joint(
        self,
        waypoint: Waypoint,
        joint: str,
        q: float,
        speed: float,
        limits: JointLimits,
    ) -> None:
        low, high = limits.min_position, limits.max_position
        if low is not None and high is not None and not low <= q <= high:
            raise InvalidTrajectoryError(
                f"The waypoint {show(waypoint.name)} of the path '{self.path}' puts "
                f"{joint} at {q:.4g}; allowed are {low:.4g} to {high:.4g}.",
                remedy="Change the waypoint.",
                details={"joint": joint},
            )
        most = limits.max_velocity
        if most is not None and speed > most:
            longer = waypoint.duration * speed / most + 0.1
            raise InvalidTrajectoryError(
                f"On the way to {show(waypoint.name)} {joint} would reach {speed:.3g}; "
                f"its velocity limit is {most:.3g}.",
                remedy=f"Give it {longer:.1f} s or more, or play slower.",
                details={"joint": joint},
            )


def plan_path(
    path: WaypointPath,
    first: int,
    joints: Sequence[str],
    start: Sequence[float],
    speed: float,
    since: Mapping[str, float] | None = None,
) -> PathPlan:
    """Plan the motion from the present positions to the end of a path.

    Args:
        path: The path.
        first: Number of the first waypoint, from 0.
        joints: The joints, n of them.
        start: Present positions [rad or m], shape (n,).
        speed: Factor of all speeds, > 0.
        since: Positions at which the motion to the first waypoint began [rad or m], by
            joint, if that motion is under way; the remaining part then takes its share
            of the waypoint's duration. None if the motion begins now.
    """
    waypoints = path.waypoints[first:]
    places, times = [], []
    before, at = list(start), 0.0
    for index, waypoint in enumerate(waypoints):
        part = 1.0
        if index == 0 and since is not None:
            part = _part_left(since, waypoint, joints, start)
        at += max(waypoint.duration * part, _SHORTEST) / speed
        before = [
            waypoint.positions.get(joint, q)
            for joint, q in zip(joints, before, strict=True)
        ]
        places.append(before)
        times.append(at)
    states = through_waypoints(start, places, times)
    return PathPlan(path.name, joints, start, waypoints, states)


def _part_left(
    since: Mapping[str, float],
    after: Waypoint,
    joints: Sequence[str],
    start: Sequence[float],
) -> float:
    """Return the share of the motion to a waypoint that is left, 0 to 1."""
    left = whole = 0.0
    for joint, q in zip(joints, start, strict=True):
        end = after.positions.get(joint, q)
        left = max(left, abs(end - q))
        whole = max(whole, abs(end - since.get(joint, q)))
    return 1.0 if whole == 0.0 else min(left / whole, 1.0)
