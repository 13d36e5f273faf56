"""Waypoint paths: captured, edited, kept on disk, and planned as trajectory goals."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import isfinite
from pathlib import Path

from pydantic import TypeAdapter
from typing_extensions import override

from station.core.control.controller_manager import ControllerManager
from station.core.errors import (
    InvalidTrajectoryError,
    LoopError,
    WaypointPathError,
    WaypointPathNotFoundError,
    show,
    suggest,
)
from station.core.hardware.limits import JointLimits
from station.core.loop.control_loop import ControlLoop
from station.core.trajectory import PosVelAccState, peak_speeds, through_waypoints
from station.library.yaml_folder import FileKind, Library
from station.reports import Waypoint, WaypointPath

MOST_WAYPOINTS = 500
"""Most waypoints of one path."""
LONGEST = 600.0
"""Longest time from one waypoint to the next [s]."""
_KIND = FileKind(
    "waypoint path", "waypoint-paths", WaypointPathNotFoundError, WaypointPathError
)
_WAYPOINTS = TypeAdapter(tuple[Waypoint, ...])
_SHORTEST = 0.1
"""Shortest time to the next waypoint, e.g. when a path is resumed between two [s]."""


class WaypointPaths(Library[WaypointPath]):
    """The waypoint paths in a folder. Any thread.

    Args:
        loop: Control loop, which knows the joints and their positions.
        manager: Controller manager of the loop.
        folder: Folder of the files; the user's own folder when None.
    """

    def __init__(
        self, loop: ControlLoop, manager: ControllerManager, folder: Path | None = None
    ) -> None:
        self._loop = loop
        self._manager = manager
        super().__init__(_KIND, folder)

    def save(self, name: str, waypoints: Sequence[Waypoint]) -> WaypointPath:
        """Save a path; it replaces a path of the same name.

        Raises:
            WaypointPathNotFoundError: The name is not allowed.
            WaypointPathError: The file cannot be written.
            InvalidTrajectoryError: A joint is unknown, or a number is impossible.
        """
        with self._files.changing(name):
            return self._save(name, waypoints)

    def capture(
        self, name: str, waypoint: str = "", duration: float = 2.0
    ) -> WaypointPath:
        """Add the present positions to the end of a path, and return the path.

        It captures the joints that loaded trajectory controllers move, or all joints
        without such a controller.

        Args:
            name: The path; a new one begins with this waypoint.
            waypoint: Name of the waypoint; `point N` when empty.
            duration: Time to it from the waypoint before [s], > 0.

        Raises:
            WaypointPathNotFoundError: The name is not allowed.
            WaypointPathError: The file cannot be read or written.
            InvalidTrajectoryError: The duration is out of range, or the path has too
                many waypoints.
            LoopError: No cycle has run yet.
        """
        positions = self.present_positions()
        # Two captures at the same time, even by two stations, must not lose a waypoint.
        with self._files.changing(name):
            known = self.get(name).waypoints if name in self.names() else ()
            added = Waypoint(waypoint or _free_name(known), duration, positions)
            return self._save(name, (*known, added))

    def present_positions(self) -> dict[str, float]:
        """Return the positions of the trajectory controllers' joints [rad or m].

        Raises:
            LoopError: No cycle has run yet.
        """
        snapshot = self._loop.snapshots.latest()
        if snapshot is None:
            raise LoopError("No cycle has run yet.", remedy="Start the control loop.")
        found = dict(zip(self._loop.joint_names, snapshot.position, strict=True))
        moved = {
            joint
            for status in self._manager.controller_statistics()
            if (loaded := self._manager.get_controller(status.name)).trajectories
            for joint in loaded.joint_names
        }
        return {joint: q for joint, q in found.items() if joint in moved or not moved}

    def _save(self, name: str, waypoints: Sequence[Waypoint]) -> WaypointPath:
        _check(waypoints)
        for waypoint in waypoints:
            for joint in waypoint.positions:
                if joint not in self._loop.joint_names:
                    raise InvalidTrajectoryError(
                        f"The waypoint {show(waypoint.name)} has a position of the "
                        f"joint {show(joint)}, which this robot does not have.",
                        remedy=suggest(joint, self._loop.joint_names),
                        details={"joint": joint},
                    )
        kept = tuple(replace(w, positions=dict(w.positions)) for w in waypoints)
        now = self._write(name, {"waypoints": [asdict(each) for each in kept]})
        return WaypointPath(name, now, kept)

    @override
    def _parse(
        self, name: str, saved_at: str, data: Mapping[str, object]
    ) -> WaypointPath:
        waypoints = _WAYPOINTS.validate_python(data.get("waypoints"))
        _check(waypoints)
        return WaypointPath(name, saved_at, waypoints)


def _free_name(known: Sequence[Waypoint]) -> str:
    taken = {waypoint.name for waypoint in known}
    numbers = range(len(known) + 1, 2 * len(known) + 2)
    return next(name for n in numbers if (name := f"point {n}") not in taken)


def _check(waypoints: Sequence[Waypoint]) -> None:
    """Refuse waypoints that do not form a path.

    Raises:
        InvalidTrajectoryError: There are too many waypoints, or one has an impossible
            number or no position.
    """
    if len(waypoints) > MOST_WAYPOINTS:
        raise InvalidTrajectoryError(
            f"The path has {len(waypoints)} waypoints; allowed are {MOST_WAYPOINTS}.",
            remedy="Divide it into two paths.",
        )
    for waypoint in waypoints:
        what = f"The waypoint {show(waypoint.name)}"
        if not 0.0 < waypoint.duration <= LONGEST:
            raise InvalidTrajectoryError(
                f"{what} has the duration {waypoint.duration} s; it must be above 0 "
                f"and at most {LONGEST:g} s.",
                remedy="Give a duration in that range.",
            )
        if not waypoint.positions or not all(
            map(isfinite, waypoint.positions.values())
        ):
            raise InvalidTrajectoryError(
                f"{what} needs a finite position of one joint or more.",
                remedy="Capture it anew, or give its positions.",
            )


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
