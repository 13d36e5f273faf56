"""Play waypoint paths, one trajectory goal per round; pause, resume and loop them."""

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from station.core.control.controller_manager import ControllerManager
from station.core.errors import PathRefusedError, StationError, counted
from station.core.facade.motion_commands import MotionCommands
from station.core.loop.control_loop import ControlLoop
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import Goal, GoalStatus
from station.library.waypoint_paths import PathPlan, WaypointPaths, plan_path
from station.reports import Playback, PlaybackState, WaypointPath

SLOWEST, FASTEST = 0.05, 2.0
"""Bounds of the factor that multiplies all speeds of a path."""
LOOK_PERIOD = 0.05
"""Time between two looks at the goal of a path that plays [s wall time]."""


@dataclass(frozen=True, slots=True)
class PlayOptions:
    """The options of playing a path.

    Attributes:
        controller: The trajectory controller; None for the one that runs and moves a
            joint of the path.
        speed: Factor of all speeds, `SLOWEST` to `FASTEST`.
        loop: Begin again at the end.
        first: Number of the first waypoint to move to, from 0.
        last: Number of the last one; the path's last one when None.
    """

    controller: str | None = None
    speed: float = 1.0
    loop: bool = False
    first: int = 0
    last: int | None = None


@dataclass(slots=True)
class _Round:
    """One goal of the path, from the robot's present position to the last waypoint.

    Attributes:
        goal: The goal.
        begins: Number of the first waypoint of the goal.
        times: Times at which the goal passes its waypoints, from `begins` on [s].
        since: Positions at which the motion to the goal's first waypoint began [rad or
            m], by joint.
    """

    goal: Goal
    begins: int
    times: list[float]
    since: Mapping[str, float]


class PathPlayer:
    """Plays one waypoint path at a time. Any thread.

    The robot follows goals of a trajectory controller. Whatever ends a goal (a stop,
    another goal, a switch, a tolerance) therefore ends the path for good.

    Args:
        loop: The control loop.
        manager: Controller manager of the loop.
        motion: Sends goals to controllers.
        paths: Saved paths.
        watch: Calls a function repeatedly until the function returns False. None does
            this in a thread; a test passes a function of its own.
    """

    def __init__(
        self,
        loop: ControlLoop,
        manager: ControllerManager,
        motion: MotionCommands,
        paths: WaypointPaths,
        watch: Callable[[Callable[[], bool]], None] | None = None,
    ) -> None:
        self._loop = loop
        self._manager = manager
        self._motion = motion
        self._paths = paths
        self._watch = watch or _watch_in_thread
        self._lock = threading.Lock()
        self._playback: Playback | None = None
        self._path: WaypointPath | None = None
        self._round: _Round | None = None
        self._first = 0
        self._epoch = 0
        self._play = 0

    def state(self) -> Playback | None:
        """Return the path that plays or played last; None if no path has played."""
        with self._lock:
            self._look()
            return self._playback

    def plan_goal(self, name: str, options: PlayOptions) -> dict[str, object]:
        """Return the goal with which a path would begin, without giving it.

        Args:
            name: The path.
            options: How it would be played.

        Returns:
            The goal as an input of the station.

        Raises:
            WaypointPathNotFoundError: There is no path of that name.
            WaypointPathError: Its file cannot be read or is malformed.
            PathRefusedError: No running trajectory controller moves the joints of the
                path, or the path has no such waypoint.
            InvalidTrajectoryError: The path is too fast for a joint, or leaves its
                range.
        """
        path = self._chosen(name, options)
        controller = options.controller or self._find_controller(path)
        plan = self._plan(path, controller, options.first, options.speed)
        return {"kind": "goal", "name": controller, "request": plan.goal()}

    def play(
        self,
        name: str,
        options: PlayOptions | None = None,
        ticket: CommandTicket | None = None,
    ) -> Playback:
        """Begin a path at its first waypoint; a path that plays now is replaced.

        Args:
            name: The path.
            options: How it is played.
            ticket: Notes the cycle that takes the first goal of the path.

        Raises:
            WaypointPathNotFoundError: There is no path of that name.
            WaypointPathError: Its file cannot be read or is malformed.
            PathRefusedError: No running trajectory controller moves the joints of the
                path, or the path has no such waypoint.
            InvalidTrajectoryError: The path is too fast for a joint, or leaves its
                range.
            StationError: The controller refuses the goal; nothing moves.
        """
        options = options or PlayOptions()
        path = self._chosen(name, options)
        with self._lock:
            controller = options.controller or self._find_controller(path)
            self._epoch = self._loop.epoch
            playback = Playback(
                path=name,
                controller=controller,
                state=PlaybackState.PLAYING,
                speed=options.speed,
                loop=options.loop,
                rounds=0,
                waypoint=0,
                waypoints=0,
                progress=0.0,
                remaining=0.0,
                message="",
            )
            self._begin(path, playback, options.first, ticket=ticket)
            self._first = options.first
            self._play += 1
            play = self._play
            found = self._playback or playback
        self._watch(lambda: self._goes_on(play))
        return found

    def _chosen(self, name: str, options: PlayOptions) -> WaypointPath:
        """Return a path without the waypoints after the last one that is played.

        Raises:
            PathRefusedError: The path has no such waypoint.
        """
        path = self._paths.get(name)
        last = len(path.waypoints) - 1 if options.last is None else options.last
        if not 0 <= options.first <= last < len(path.waypoints):
            raise PathRefusedError(
                f"The path '{name}' has "
                f"{counted(len(path.waypoints), 'waypoint')}; asked for "
                f"were those from {options.first} to {last}, counted from 0.",
                remedy="Capture waypoints first, or name those there are.",
            )
        return replace(path, waypoints=path.waypoints[: last + 1])

    def pause(self) -> Playback:
        """Let the robot hold its position between two waypoints.

        Raises:
            PathRefusedError: No path plays.
        """
        with self._lock:
            playback = self._active()
            if playback.state is PlaybackState.PLAYING and self._round is not None:
                # Set the state before the goal ends: the watching thread would
                # otherwise take this end for one that came from outside.
                self._playback = replace(playback, state=PlaybackState.PAUSED)
                self._motion.cancel_goal(
                    playback.controller, self._round.goal.identifier
                )
            return self._active()

    def resume(self) -> Playback:
        """Resume the motion to the present waypoint.

        Raises:
            PathRefusedError: No path is paused.
            StationError: The controller refuses the goal; the path stays paused.
        """
        with self._lock:
            playback = self._active()
            if playback.state is PlaybackState.PAUSED and self._path is not None:
                playing = replace(playback, state=PlaybackState.PLAYING)
                self._begin(self._path, playing, playback.waypoint, self._since())
            return self._active()

    def adjust(
        self, *, speed: float | None = None, loop: bool | None = None
    ) -> Playback:
        """Change speed or loop of the path that plays or is paused.

        Args:
            speed: Factor of all speeds, `SLOWEST` to `FASTEST`; None keeps the setting.
            loop: Whether the path begins again at its end; None keeps the setting.

        Raises:
            PathRefusedError: No path plays.
            StationError: The path would be too fast; nothing has changed.
        """
        with self._lock:
            playback = self._active()
            wanted = replace(
                playback,
                speed=playback.speed if speed is None else speed,
                loop=playback.loop if loop is None else loop,
            )
            is_playing = wanted.state is PlaybackState.PLAYING
            if wanted.speed != playback.speed and is_playing and self._path is not None:
                self._begin(self._path, wanted, playback.waypoint, self._since())
            else:
                self._playback = wanted
            return self._active()

    def cancel(self) -> Playback:
        """End the path; the robot holds where it is.

        Raises:
            PathRefusedError: No path plays.
        """
        with self._lock:
            playback = self._active()
            self._playback = replace(playback, state=PlaybackState.CANCELLED)
            if self._round is not None:
                self._motion.cancel_goal(
                    playback.controller, self._round.goal.identifier
                )
            return self._playback

    def _goes_on(self, play: int) -> bool:
        """Advance a path; return whether it has not ended."""
        with self._lock:
            if play != self._play:
                return False
            self._look()
            return self._playback is not None and not _is_final(self._playback)

    def _active(self) -> Playback:
        self._look()
        if self._playback is None or _is_final(self._playback):
            raise PathRefusedError(
                "No waypoint path plays or is paused.", remedy="Play one."
            )
        return self._playback

    def _look(self) -> None:
        """Note the goal's progress; at its end begin a new round or end the path."""
        playback, now = self._playback, self._round
        if playback is None or now is None or self._path is None:
            return
        if playback.state is PlaybackState.PAUSED and self._loop.epoch != self._epoch:
            text = "A stop, a reset or a recovery came while it was paused."
            self._playback = replace(
                playback, state=PlaybackState.ABORTED, message=text
            )
        if playback.state is not PlaybackState.PLAYING:
            return
        passed = now.goal.progress * now.times[-1]
        behind = sum(time <= passed for time in now.times[:-1])
        self._playback = playback = replace(
            playback,
            waypoint=now.begins + behind,
            progress=_share(now, passed, len(self._path.waypoints)),
            remaining=max(now.times[-1] - passed, 0.0),
        )
        if not now.goal.is_final():
            return
        if now.goal.status is not GoalStatus.SUCCEEDED:
            result = now.goal.result
            why = result.message if result is not None and result.message else ""
            self._playback = replace(
                playback,
                state=PlaybackState.ABORTED,
                message=why or f"Its goal was {now.goal.status.value}.",
            )
            return
        done = replace(
            playback, rounds=playback.rounds + 1, progress=1.0, remaining=0.0
        )
        self._playback = replace(done, state=PlaybackState.SUCCEEDED)
        if playback.loop:
            try:
                self._begin(self._path, done, self._first)
            except StationError as error:
                self._playback = replace(
                    done, state=PlaybackState.ABORTED, message=str(error)
                )

    def _since(self) -> Mapping[str, float]:
        """Return the start of the motion to this waypoint [rad or m], by joint."""
        if self._playback is None or self._path is None or self._round is None:
            return {}
        number = self._playback.waypoint
        passed = self._path.waypoints[self._round.begins : number]
        found = dict(self._round.since)
        for waypoint in passed:
            found.update(waypoint.positions)
        return found

    def _begin(
        self,
        path: WaypointPath,
        playback: Playback,
        first: int,
        since: Mapping[str, float] | None = None,
        ticket: CommandTicket | None = None,
    ) -> None:
        """Send a goal from the present position through the waypoints from `first`."""
        plan = self._plan(path, playback.controller, first, playback.speed, since)
        goal = self._motion.submit_goal(
            playback.controller,
            plan.goal(),
            self._epoch,
            ticket=ticket,
        )
        here = zip(plan.joints, plan.start, strict=True)
        began = dict(here) if since is None else since
        self._path, self._round = path, _Round(goal, first, plan.times, began)
        self._playback = replace(
            playback,
            waypoint=first,
            waypoints=len(path.waypoints),
            remaining=plan.times[-1],
        )

    def _plan(
        self,
        path: WaypointPath,
        controller: str,
        first: int,
        speed: float,
        since: Mapping[str, float] | None = None,
    ) -> PathPlan:
        joints = self._manager.get_controller(controller).joint_names
        start = self._motion.query_state(controller).position
        plan = plan_path(path, first, joints, start, speed, since)
        plan.check({each.joint: each.limits for each in self._loop.hw.joint_limits()})
        return plan

    def _find_controller(self, path: WaypointPath) -> str:
        joints = {joint for each in path.waypoints for joint in each.positions}
        fitting = []
        for status in self._manager.controller_statistics():
            loaded = self._manager.get_controller(status.name)
            if loaded.trajectories is None or joints.isdisjoint(loaded.joint_names):
                continue
            if loaded.is_running():
                return status.name
            fitting.append(status.name)
        raise PathRefusedError(
            f"No trajectory controller that moves joints of the path '{path.name}' is "
            "running.",
            remedy=f"Start one of: {', '.join(fitting)}."
            if fitting
            else "Load and start a JointTrajectoryController of these joints.",
            details={"controllers": fitting},
        )


def _is_final(playback: Playback) -> bool:
    return playback.state not in {PlaybackState.PLAYING, PlaybackState.PAUSED}


def _share(now: _Round, passed: float, waypoints: int) -> float:
    """Return the share of the waypoints that the robot has passed, 0 to 1."""
    begin, done = 0.0, float(now.begins)
    for time_there in now.times:
        if passed >= time_there:
            done += 1.0
        else:
            done += max(passed - begin, 0.0) / (time_there - begin)
            break
        begin = time_there
    return min(done / waypoints, 1.0)


def _watch_in_thread(look: Callable[[], bool]) -> None:
    def run() -> None:
        while look():
            time.sleep(LOOK_PERIOD)

    threading.Thread(target=run, name="path player", daemon=True).start()
