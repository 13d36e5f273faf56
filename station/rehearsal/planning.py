"""Plan motions without collisions, in a copy of the station, and check their poses."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from station.core.errors import (
    InvalidCommandError,
    InvalidTrajectoryError,
    NoPathError,
    suggest,
)
from station.core.franka.franka_services import FrankaServices
from station.core.trajectory import PosVelAccState, peak_speeds, through_waypoints
from station.core.trajectory.quintic_spline_segment import QuinticSplineSegment
from station.rehearsal.path_search import Joints, PathSearch
from station.rehearsal.pose_goals import end_effector_of, joints_at, target_pose
from station.rehearsal.process_copy import run_in_copy
from station.reports import Plan

if TYPE_CHECKING:
    from station.core.facade.station import Station

_SLACK = 0.004
"""How much nearer than allowed bodies may come on the timed path [m]: it is checked at
other poses than the search has checked."""
_INSIDE = 1e-3
"""Distance that a path keeps from the ends of the joints' ranges [rad or m]."""
_SPEED = 0.4
"""Share of the velocity limits that a path uses, so that accelerations stay small."""
_CALM = 1.0
"""Mean speed of a joint without a velocity limit [rad/s or m/s]."""
_ACCELERATION = 2.0
"""Peak acceleration of a segment that begins and ends at rest [rad/s^2 or m/s^2]. A
Franka allows 7.5; faster changes of speed look like a contact to its observer."""
_PEAK = 10.0 / 3.0**0.5
"""Peak acceleration of a quintic polynomial from rest to rest, divided by distance /
time^2."""
_SHORTEST = 0.3
"""Shortest time of a segment [s]."""
_SAMPLE = 0.01
"""Time between two checks of the timed path [s]."""
MARGIN = 0.01
"""Least distance of bodies that are farther apart at the beginning [m]. For an object
with a role, it is added to the object's own margin."""
DEPTH = 0.001
"""How much nearer two bodies may come that are near each other at the beginning [m]."""
_APART = 0.035
"""Least distance of two parts of a Franka [m]; the arm ends a motion at 0.03."""

Pair = tuple[str, str, float, float]
"""Names of two bodies, their distance [m], and the distance to keep [m]."""


@dataclass(frozen=True, slots=True)
class Wish:
    """A request for a path: its target and the limits of the search.

    Attributes:
        controller: A running trajectory controller.
        positions: Target positions [rad or m], by joint; others stay.
        place: Target pose of a Franka's end effector in the frame of its base, in place
            of `positions`: position [m], shape (3,), and quaternion x, y, z, w, or None
            for the present orientation.
        timeout: How long to search [s], > 0.
        seed: Seed of the random numbers.
        name: Name of a pose of the robot, in place of a target above; empty for none.
    """

    controller: str
    positions: Mapping[str, float] = field(default_factory=dict)
    place: tuple[Sequence[float], Sequence[float] | None] | None = None
    timeout: float = 2.0
    seed: int = 0
    name: str = ""


def plan(station: "Station", wish: Wish) -> Plan:
    """Return a path from the present positions of a controller's joints to a target.

    Args:
        station: The station; its robot must be simulated.
        wish: Target and limits of the search; its `name` is ignored.

    Raises:
        ControllerNotFoundError: No such controller is loaded.
        ControllerStateError: The controller is not running.
        InvalidCommandError: The controller takes no trajectories, has no such joint, or
            moves no end effector.
        InvalidTrajectoryError: A joint would leave its range.
        NoPathError: The target is in collision or out of reach, or no path was found in
            time.
        RehearsalError: The robot is not simulated, or this machine cannot copy the
            station.
    """
    start = station.motion.query_state(wish.controller).position
    joints = list(station.manager.get_controller(wish.controller).joint_names)
    goal = _goal_of(station, wish, joints, start)
    begun = time.perf_counter()

    def work(
        tell: Callable[[], None],
    ) -> list[Plan | NoPathError | InvalidCommandError] | None:
        del tell
        if not station.loop.go_on_without_thread():
            return None
        try:
            return [_Planner(station, wish, joints, np.array(start)).find_plan(goal)]
        except (NoPathError, InvalidCommandError) as error:
            return [error]

    (found,) = run_in_copy(work, station.loop.wait_between_cycles, wish.timeout + 2.0)
    if not isinstance(found, Plan):
        raise found
    return replace(found, planning_time=time.perf_counter() - begun)


def _goal_of(
    station: "Station", wish: Wish, joints: list[str], start: list[float]
) -> Joints:
    """Return the goal of the joints, shape (n,).

    Raises:
        InvalidCommandError: The controller has no such joint.
        InvalidTrajectoryError: A joint would leave its range.
    """
    for name in wish.positions:
        if name not in joints:
            raise InvalidCommandError(
                f"'{wish.controller}' moves no joint '{name}'.",
                remedy=suggest(name, joints),
            )
    limits = {one.joint: one.limits for one in station.loop.hw.joint_limits()}
    for name, q in wish.positions.items():
        found = limits.get(name)
        low = None if found is None else found.min_position
        high = None if found is None else found.max_position
        if low is not None and high is not None and not low <= q <= high:
            raise InvalidTrajectoryError(
                f"{name} cannot go to {q:.4g}; allowed are {low:.4g} to {high:.4g}.",
                remedy="Choose another pose.",
                details={"joint": name, "cause": "unreachable"},
            )
    pairs = zip(joints, start, strict=True)
    return np.array([wish.positions.get(name, q) for name, q in pairs])


class _Planner:
    """Plans in a copy of the station, where it may put the world into any pose."""

    def __init__(
        self, station: "Station", wish: Wish, joints: list[str], start: Joints
    ) -> None:
        self._station = station
        self._wish = wish
        self._joints = joints
        limits = {one.joint: one.limits for one in station.loop.hw.joint_limits()}
        found = [limits.get(name) for name in joints]
        self._lower = np.array([
            -np.pi if one is None or one.min_position is None else one.min_position
            for one in found
        ])
        self._upper = np.array([
            np.pi if one is None or one.max_position is None else one.max_position
            for one in found
        ])
        self._speeds = np.array([
            _CALM if one is None or not one.max_velocity else _SPEED * one.max_velocity
            for one in found
        ])
        self._judge = PoseJudge(station, joints, start)
        self._start = start

    def find_plan(self, goal: Joints) -> Plan:
        """Return a path without collisions, with times.

        Raises:
            InvalidCommandError: The controller moves no end effector.
            NoPathError: The goal is in collision, or no path was found in time.
        """
        deadline = time.perf_counter() + self._wish.timeout
        inside = np.full(len(self._joints), _INSIDE)
        limits = self._lower + inside, self._upper - inside
        goals = self._goals(goal, limits)
        clear = [one for one in goals if self._judge.is_clear(one)]
        if not clear:
            raise self._in_collision(goals[0])
        search = PathSearch(self._judge.is_clear, *limits, self._wish.seed)
        while (path := search.find(self._start, clear, deadline)) is not None:
            # The path may still collide between the poses that the search has checked.
            states = self._timed(path)
            if states is not None:
                return self._plan_of(path, states)
        raise NoPathError(
            f"No path was found within {self._wish.timeout:g} s.",
            remedy="Allow more time, or go by way of another pose.",
            details={"cause": "timeout"},
        )

    def _in_collision(self, goal: Joints) -> NoPathError:
        pairs = self._judge.blocked(goal)
        one, other, distance, kept = min(pairs, key=lambda pair: pair[2] - pair[3])
        return NoPathError(
            f"{one} and {other} would be {1e3 * distance:.0f} mm from each other in "
            f"that pose; {1e3 * kept:.0f} mm are kept free."
            if distance > 0.0
            else f"{one} would come {-1e3 * distance:.0f} mm into {other} in that "
            "pose.",
            remedy="Choose another pose, or move what is in the way.",
            details={"cause": "goal_in_collision", "pair": [one, other]},
        )

    def _plan_of(self, path: list[Joints], states: list[PosVelAccState]) -> Plan:
        points = [
            {
                "positions": list(state.position),
                "velocities": list(state.velocity),
                "accelerations": list(state.acceleration),
                "time_from_start": state.time_from_start,
            }
            for state in states
        ]
        return Plan(
            self._wish.controller,
            {"trajectory": {"joint_names": self._joints, "points": points}},
            states[-1].time_from_start,
            len(path) == 2,
            0.0,
            self._joints,
            [pose.tolist() for pose in path],
        )

    def _goals(self, goal: Joints, limits: tuple[Joints, Joints]) -> list[Joints]:
        """Return some positions of the joints that reach the target.

        Raises:
            InvalidCommandError: The controller moves no end effector.
            NoPathError: The end effector cannot reach the target.
        """
        if self._wish.place is None:
            return [goal]
        hand = end_effector_of(self._station, self._wish.controller, self._joints)
        return joints_at(
            hand,
            target_pose(hand.pose(self._start), *self._wish.place),
            self._start,
            limits,
            self._joints,
            seed=self._wish.seed,
            accept=self._judge.is_clear,
        )

    def _timed(self, path: list[Joints]) -> list[PosVelAccState] | None:
        """Return a path with times: without stops if this is clear, else with stops.

        Returns:
            The states at its corners; None if it collides even with a stop at every
            corner.
        """
        places = [pose.tolist() for pose in path]
        spans = [
            max(
                float(np.max(np.abs(b - a) / self._speeds)),
                float(np.max(np.abs(b - a)) * _PEAK / _ACCELERATION) ** 0.5,
                _SHORTEST,
            )
            for a, b in pairwise(path)
        ]
        times = np.cumsum(spans).tolist()
        in_one_go = through_waypoints(places[0], places[1:], times)
        rest = [0.0] * len(self._joints)
        stopping = [
            PosVelAccState(place, rest, rest, at)
            for place, at in zip(places[1:], times, strict=True)
        ]
        for states in (in_one_go, stopping):
            peaks = np.array(peak_speeds(places[0], states)) / self._speeds
            slower = max(float(peaks.max()) * _SPEED, 1.0)
            slow = [
                PosVelAccState(
                    one.position,
                    [v / slower for v in one.velocity],
                    one.acceleration,
                    one.time_from_start * slower,
                )
                for one in states
            ]
            if self._is_clear_in_time(places[0], slow):
                return slow
        return None

    def _is_clear_in_time(
        self, start: list[float], states: list[PosVelAccState]
    ) -> bool:
        rest = [0.0] * len(start)
        before = PosVelAccState(start, rest, rest, 0.0)
        for state in states:
            begin, end = before.time_from_start, state.time_from_start
            segment = QuinticSplineSegment(begin, before, end, state)
            for at in np.arange(begin, end, _SAMPLE).tolist():
                if self._judge.blocked(np.array(segment.sample(at).position), _SLACK):
                    return False
            before = state
        return True


class PoseJudge:
    """Finds pairs that are too near in a pose; in a copy of the station only.

    MuJoCo finds solid bodies, the scene guards find objects with a role, and the model
    of each Franka finds its own parts.

    Args:
        station: The station; its world stays in the pose that was checked last.
        joints: Names of the joints of a pose.
        start: First pose [rad or m]; pairs that are near in this pose may stay near.

    Raises:
        NoPathError: The robot is not simulated.
    """

    def __init__(
        self, station: "Station", joints: Sequence[str], start: Joints
    ) -> None:
        world = station.loop.hw.simulated_world()
        if world is None:
            raise NoPathError(
                "What is around a real robot is not known.",
                remedy="Plan on a simulated station with its scene.",
            )
        self._joints = joints
        self._surroundings = station.surroundings
        kind: type[FrankaServices] = FrankaServices  # type: ignore[type-abstract]
        self._arms = []
        for arm_id in station.robots.names(kind):
            arm = station.robots.get(arm_id, kind)
            names = [f"{arm_id}_joint{number}" for number in range(1, 8)]
            if arm is not None and set(names) & set(joints):
                q = arm.get_robot_state().q
                self._arms.append((arm.model().model, arm_id, names, q))
        carried = {
            one.name: f"{one.carried_by}_link7"
            for one in station.scene()
            if one.solid and one.carried_by
        }
        self._near = world.nearness(joints, MARGIN, carried)
        self._allowed: dict[tuple[str, str], float] = {}
        for one, other, distance, _ in self._pairs(start):
            before = self._allowed.get((one, other), distance)
            self._allowed[one, other] = min(before, distance)

    def blocked(self, pose: Joints, slack: float = DEPTH) -> list[Pair]:
        """Return the pairs that are nearer to each other than they may be.

        Args:
            pose: Positions of the joints [rad or m], shape (n,).
            slack: How much nearer than allowed a pair may be [m].
        """
        return [
            pair
            for pair in self._pairs(pose)
            if pair[2] < self._allowed.get(pair[:2], pair[3]) - slack
        ]

    def is_clear(self, pose: Joints) -> bool:
        """Return whether no pair is nearer than allowed."""
        return not self.blocked(pose)

    def _pairs(self, pose: Joints) -> list[Pair]:
        """Return the pairs that are nearer than the distance to keep."""
        values = pose.tolist()
        found = [(*pair, MARGIN) for pair in self._near(values)]
        positions = dict(zip(self._joints, values, strict=True))
        for pair in self._surroundings.nearest_at(positions):
            kept = pair.margin + MARGIN
            if pair.distance < kept:
                link = f"{pair.arm}_{pair.link}"
                found.append((link, pair.object, pair.distance, kept))
        for model, arm_id, names, here in self._arms:
            q = [positions.get(n, value) for n, value in zip(names, here, strict=True)]
            apart = model.clearance(q)
            if apart < _APART:
                found.append((arm_id, "itself", apart, _APART))
        return found
