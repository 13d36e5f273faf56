"""Execute a trajectory in time: plan requests, sample, supervise the goal.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller_impl.h.
"""

import threading
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, pi

from typing_extensions import override

from station.controllers.joint_trajectory_controller.goal_supervision import (
    GoalSupervision,
    StateErrors,
)
from station.controllers.joint_trajectory_controller.joint_tracking import (
    JointTracking,
)
from station.controllers.joint_trajectory_controller.request_limits import (
    check_positions,
    check_segment,
    check_times,
)
from station.controllers.joint_trajectory_controller.speed_scaling import SpeedScaling
from station.controllers.joint_trajectory_controller.trajectory_update import (
    TrajectoryTime,
    TrajectoryUpdate,
)
from station.controllers.set_point_controller import CommandLaw
from station.core.control.sample_columns import SampleColumns
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import Goal, GoalResult, GoalStatus
from station.core.ports.receipt import Receipt
from station.core.ports.set_point import RANGE_TOLERANCE
from station.core.trajectory import (
    JointTolerances,
    JointTrajectory,
    JointTrajectorySegment,
    PosVelAccState,
    SegmentTrajectory,
    StateTolerances,
    TrajectoryOptions,
    check_joint_names,
    find_segment,
    hold_trajectory,
    init_joint_trajectory,
    sample_segments,
    stop_trajectory,
)
from station.core.trajectory.ros_time import to_nanoseconds, to_seconds
from station.memory.doubles import zeros

_STANDSTILL = 1e-6
"""Speed scaling below which a trajectory counts as paused."""
_HALF_TURN = pi * (1.0 + 1e-6)
"""Largest angle without whole turns, with the rounding of written numbers [rad]."""
_STANDS = 1e-6
"""How exactly a joint stands where a request has measured it to be [rad or m]."""
_KEPT = 8
"""Number of replaced trajectories kept until a planning thread frees them."""


@dataclass(frozen=True, slots=True)
class _Request:
    """A planned trajectory that the control thread has yet to take up.

    Attributes:
        trajectory: The segments of every joint; None to stop and hold.
        is_void: Whether what was commanded counts no longer, so that the joints hold
            where they are.
        goal: The goal that ends with the trajectory; None for a trajectory without one.
        receipt: Where the cycle is noted that takes the request up.
    """

    trajectory: SegmentTrajectory | None
    goal: Goal | None
    receipt: Receipt | None = None
    is_void: bool = False


@dataclass(frozen=True, slots=True)
class _Present:
    """What a new trajectory continues from.

    Attributes:
        time: Station time of the last cycle [s].
        period: Its time since the cycle before [s].
        uptime: Trajectory time of the cycle [ns].
        trajectory: What is executed after all queued requests.
        places: Where each joint is by name: commanded and measured [rad or m].
        rests: Whether no joint is to move and no request waits.
    """

    time: float
    period: float
    uptime: int
    trajectory: SegmentTrajectory
    places: Mapping[str, tuple[float, float]]
    rests: bool


class TrajectoryExecution(TrajectoryTime):
    """The trajectory that is executed, from the request to the desired states.

    `plan`, `hold` and `query` may be called from any thread; all other methods belong
    to the control thread. `plan` computes a new trajectory in the caller's thread, and
    the next cycle takes the trajectory up. Cycles that pass during the computation make
    the bridge to the new trajectory late; a late bridge is computed anew from the
    desired states in the cycle that takes the trajectory up.

    Args:
        joints: The joints.
        tracking: Their measured states; receives desired states and errors.
        stop_duration: Time in which a motion is ended [s]; 0 to hold at once.
        path_bounds: Path tolerances of trajectories without a goal, shape (n,); None
            for none.
        allow_partial_joints_goal: Whether a trajectory may leave joints out.
        speed: Speed scaling of the trajectory; full speed when None.

    Attributes:
        tracking: As given.

    Source:
        JointTrajectoryController; differs: after a violated tolerance the joints are
        stopped and held, not moved on; a stopped joint holds what was commanded, not
        what is measured, unless it has left its path tolerance; only continuous joints
        take the shortest way in the error, and a position beyond half a turn is meant
        as it is; a moving joint goes on without a step of its velocity; positions
        beyond a joint's limits are refused, and segments that are too fast or lead
        beyond the limits.
    """

    def __init__(
        self,
        joints: list[JointDescription],
        tracking: JointTracking,
        *,
        stop_duration: float = 0.0,
        path_bounds: Sequence[StateTolerances] | None = None,
        allow_partial_joints_goal: bool = False,
        speed: SpeedScaling | None = None,
    ) -> None:
        self._joints = joints
        self._names = [joint.name for joint in joints]
        self._wraps = [joint.type is JointType.CONTINUOUS for joint in joints]
        self._stop_duration = stop_duration
        self._path_bounds = path_bounds or [StateTolerances()] * len(joints)
        self._allow_partial = allow_partial_joints_goal
        super().__init__(SpeedScaling() if speed is None else speed, tracking.splines)
        self.tracking = tracking
        self._errors = StateErrors(tracking.errors, tracking.rate_errors)
        # The active segment of each joint.
        self._active: list[JointTrajectorySegment] = []
        self._trajectory: SegmentTrajectory = []
        self._retired: deque[SegmentTrajectory] = deque(maxlen=_KEPT)
        self._supervision = GoalSupervision(joints)
        self._requests: deque[_Request] = deque()
        self._planning = threading.Lock()

    def start(self, time: float) -> None:
        """Hold the measured positions, or come to rest if the joints move.

        Args:
            time: Station time [s].
        """
        tracking, memory = self.tracking, self.tracking.memory
        self.end_goals(GoalStatus.PREEMPTED, "The controller was restarted.")
        self.set_moment(time, 0.0, 0)
        tracking.positions[:] = memory.positions
        tracking.velocities[:] = memory.velocities
        tracking.accelerations[:] = zeros(len(self._joints))
        self.sampled = 0.0
        self._trajectory = self._resting(is_void=True)
        self.load_time = -inf

    def end_goals(self, status: GoalStatus, reason: str) -> None:
        """End the active goal and every waiting goal for good.

        Args:
            status: The final status of the goals.
            reason: The reason in one sentence.
        """
        self._supervision.end(status, reason)
        while self._requests:
            waiting = self._requests.popleft().goal
            if waiting is not None:
                waiting.finish(status, GoalResult(0, reason))

    def plan(
        self,
        request: JointTrajectory,
        goal: Goal | None = None,
        tolerances: Mapping[str, JointTolerances] | None = None,
        receipt: Receipt | None = None,
    ) -> None:
        """Plan a request and let the next cycle take it up.

        Args:
            request: The requested trajectory; without points: stop and hold.
            goal: The goal that ends with the trajectory. The request of a goal names
                the joints even when it has no points.
            tolerances: Bounds of the errors by joint, used with a goal.
            receipt: Where the cycle is noted that takes the request up.

        Raises:
            InvalidTrajectoryError: The request cannot be followed; nothing changed.
        """
        with self._planning:
            # Replaced trajectories are freed here, where time does not matter.
            self._retired.clear()
            planned = None
            if request.points:
                planned = self._planned(request, goal, tolerances, receipt)
            elif goal is not None:
                check_joint_names(
                    request.joint_names,
                    self._names,
                    allow_partial_joints_goal=self._allow_partial,
                )
            made = _Request(planned, goal, receipt)
            if receipt is None:
                self._requests.append(made)
            else:
                receipt.hand_over(lambda: self._requests.append(made))

    def hold(self, receipt: Receipt | None = None, *, is_void: bool = False) -> None:
        """Let the next cycle end the motion and hold. Any thread; takes no lock.

        Args:
            receipt: Where the cycle is noted that takes the request up.
            is_void: Whether what was commanded counts no longer, because of a stop, a
                reset or a recovery: the joints hold where they are.
        """
        self._requests.append(_Request(None, None, receipt, is_void))

    def advance(self, time: float, period: float) -> None:
        """Compute the desired states and the errors of the present cycle.

        Args:
            time: Station time [s].
            period: Time since the last cycle [s], >= 0.
        """
        now = self.pass_time(time, period)
        while self._requests:
            # A request stays queued until it is followed, so that a thread that plans
            # in between continues from it (see `_latest_trajectory`).
            self._take_up(self._requests[0], now)
            self._requests.popleft()
        goal = self._supervision.goal
        if goal is not None and goal.cancel_requested:
            self._supervision.end(GoalStatus.PREEMPTED, goal.cancel_reason)
            self._follow(self._resting())
            goal = None
        is_within = not self.sample(now)
        if goal is None:
            return
        if is_within and now < self.path_end:
            self._supervision.follow_progress(goal, now)
        elif self._supervision.check(self._active, self._trajectory, self._errors, now):
            self._follow(self._resting())

    def update_by(self, law: CommandLaw, sampled: SampleColumns) -> TrajectoryUpdate:
        """Return an update that follows the trajectory while it ends no goal.

        Args:
            law: Commands the joints.
            sampled: Keeps what was done.
        """
        return TrajectoryUpdate(self, self._requests, self._supervision, law, sampled)

    def query(self, time: float) -> PosVelAccState:
        """Return the desired state at a past or future time. Any thread.

        The present speed scaling is assumed for all times.

        Args:
            time: Station time [s].

        Raises:
            InvalidTrajectoryError: `time` is before the trajectory being executed.
        """
        (present, _, uptime), trajectory = self.moment, self._trajectory
        factor = self.speed.factor
        when = to_seconds(uptime) + factor * (time - present)
        states = []
        for segments in trajectory:
            if find_segment(segments, when) is None:
                raise InvalidTrajectoryError(
                    f"The time {time} s is before the trajectory being executed.",
                    remedy=f"Ask for a later time; now it is {present} s.",
                )
            states.append(sample_segments(segments, when))
        return PosVelAccState(
            [state[0] for state in states],
            [factor * state[1] for state in states],
            [factor * factor * state[2] for state in states],
        )

    def _planned(
        self,
        request: JointTrajectory,
        goal: Goal | None,
        tolerances: Mapping[str, JointTolerances] | None,
        receipt: Receipt | None,
    ) -> SegmentTrajectory | None:
        """Return the trajectory of a request; None to hold, where all joints are there.

        Raises:
            InvalidTrajectoryError: The request cannot be followed.
        """
        present = self._present()
        if receipt is not None:
            receipt.planned_at = present.time
        check_times(request, present.time)
        request, tolerances = self._stays(request, tolerances, present)
        passed = to_nanoseconds(present.period * self.speed.factor)
        following = present.uptime + passed
        options = TrajectoryOptions(
            current=present.trajectory,
            joint_names=self._names,
            angle_wraparound=self._wraps_of(request),
            other_time_base=to_seconds(following),
            allow_partial_joints_goal=self._allow_partial,
            keeps_velocity=True,
            goal=goal,
            tolerances=tolerances,
        )
        now = present.time + present.period
        try:
            return self._checked(request, now, options, present)
        except InvalidTrajectoryError as error:
            if error.details.get("reason") == "past" and request.is_due_at_once():
                self._check_arrived(request, tolerances, present)
                return None
        # Where a moving joint has no room to turn, the line of the original is left.
        options = replace(options, keeps_velocity=False)
        return self._checked(request, now, options, present)

    def _present(self) -> _Present:
        """Return what a new trajectory continues from, all of it of one cycle.

        A trajectory that is planned here continues from what it will continue from when
        the recording is run again, which plans between the same two cycles.
        """
        while True:
            moment = self.moment
            time, period, uptime = moment
            latest, places = self._latest_trajectory(), self._places()
            rests = not any(self.tracking.velocities) and not self._requests
            if self.moment is moment:
                return _Present(time, period, uptime, latest, places, rests)

    def _checked(
        self,
        request: JointTrajectory,
        now: float,
        options: TrajectoryOptions,
        present: _Present,
    ) -> SegmentTrajectory:
        planned = init_joint_trajectory(request, now, options)
        check_positions(request, self._joints, present.places)
        self._check_segments(planned, options.current or [])
        return planned

    def _wraps_of(self, request: JointTrajectory) -> list[bool]:
        """Return which joints take the short way to the first point of a request.

        Whoever means an angle sends it within half a turn, as planners do. A position
        beyond counts the turns, and to leave them out would be to report a success
        after another motion than the one that was asked for.
        """
        first = dict(
            zip(request.joint_names, request.points[0].positions, strict=False)
        )
        return [
            wraps and abs(first.get(name, 0.0)) <= _HALF_TURN
            for name, wraps in zip(self._names, self._wraps, strict=True)
        ]

    def _stays(
        self,
        request: JointTrajectory,
        tolerances: Mapping[str, JointTolerances] | None,
        present: _Present,
    ) -> tuple[JointTrajectory, Mapping[str, JointTolerances] | None]:
        """Return a request for where the joints stand as one for where they are held.

        A loaded joint stands below where it is commanded to be. If it were commanded to
        the place where it stands, it would sink instead of staying there.
        """
        places, names = present.places, request.joint_names
        point = request.points[0]
        if (
            len(request.points) > 1
            or len(point.positions) != len(names)
            or any((*point.velocities, *point.accelerations))
            or not present.rests
        ):
            return request, tolerances
        offsets: dict[str, float] = {}
        for name, wanted in zip(names, point.positions, strict=True):
            commanded, measured = places.get(name, (inf, inf))
            if abs(wanted - measured) > _STANDS:
                return request, tolerances
            offsets[name] = abs(commanded - wanted)
        held = replace(point, positions=[places[name][0] for name in names])
        widened = {
            name: each.with_wider_goal(offsets.get(name, 0.0))
            for name, each in (tolerances or {}).items()
        }
        return replace(request, points=[held]), widened

    def _places(self) -> dict[str, tuple[float, float]]:
        """Return where each joint is by name: commanded and measured [rad or m]."""
        measured = self.tracking.memory.positions
        places = zip(self.tracking.positions, measured, strict=True)
        return dict(zip(self._names, places, strict=True))

    def _check_arrived(
        self,
        request: JointTrajectory,
        tolerances: Mapping[str, JointTolerances] | None,
        present: _Present,
    ) -> None:
        """Refuse a single point that is due at once where the joints are not.

        Raises:
            InvalidTrajectoryError: A joint is somewhere else.
        """
        places = present.places
        for name, wanted in zip(
            request.joint_names, request.points[0].positions, strict=True
        ):
            bounds = (tolerances or {}).get(name, JointTolerances())
            allowed = max(bounds.goal.position, RANGE_TOLERANCE)
            distance = min((wanted - place for place in places[name]), key=abs)
            if abs(distance) > allowed:
                raise InvalidTrajectoryError(
                    f"Joint '{name}' is {abs(distance):.6g} away from the only point "
                    "of the trajectory, which is due at once.",
                    remedy="Give the point a time_from_start above 0 s.",
                    details={"reason": "past", "joint": name, "distance": distance},
                )

    def _latest_trajectory(self) -> SegmentTrajectory:
        """Return the trajectory that is executed after all queued requests."""
        try:
            latest = self._requests[-1].trajectory
        except IndexError:
            return self._trajectory
        if latest is None:  # After a stop nothing of the present trajectory goes on.
            return hold_trajectory(self.sampled, [*self.tracking.positions])
        return latest

    def _check_segments(
        self, planned: SegmentTrajectory, current: SegmentTrajectory
    ) -> None:
        """Refuse new segments that are too fast, or lead beyond the limits.

        A trajectory that starts far from where the joints are has such segments.

        Raises:
            InvalidTrajectoryError: A segment is too fast, or leads beyond the limits.
        """
        for joint, segments, before in zip(self._joints, planned, current, strict=True):
            # Segments of the present trajectory have been checked before.
            known = {id(segment.spline) for segment in before}
            for segment in segments:
                if id(segment.spline) not in known:
                    check_segment(joint, segment)

    def _take_up(self, request: _Request, now: float) -> None:
        if request.trajectory is None:
            self._follow(self._resting(request.goal, is_void=request.is_void))
        else:
            self._follow(_timely(request.trajectory, self._trajectory, now))
        self._supervision.begin(request.goal, now, self._trajectory)
        if request.receipt is not None:
            request.receipt.pick_up()

    def _follow(self, trajectory: SegmentTrajectory) -> None:
        """Execute `trajectory` from now on; `plan` frees the old trajectory."""
        # To free a long trajectory takes milliseconds, which no cycle has.
        self._retired.append(self._trajectory)
        self._trajectory = trajectory
        self.load_time = -inf

    def _resting(
        self, goal: Goal | None = None, *, is_void: bool = False
    ) -> SegmentTrajectory:
        """Return a trajectory that ends the motion, from the present cycle on.

        A stop ramp begins at the last desired state, so that the motion is continuous
        in this cycle.
        """
        now = to_seconds(self.moment[2])
        tracking = self.tracking
        if self._stop_duration == 0.0:
            held = tracking.memory.positions if is_void else self._held_positions()
            return hold_trajectory(now, held, goal)
        now = self.sampled
        factor = self.speed.factor
        if factor < _STANDSTILL:
            return hold_trajectory(now, tracking.positions, goal)
        # `stop_duration` is real time, while the ramp runs in trajectory time.
        states = zip(tracking.positions, tracking.velocities, strict=True)
        moving = [(position, velocity / factor) for position, velocity in states]
        return stop_trajectory(now, self._stop_duration * factor, moving, goal)

    def _held_positions(self) -> list[float]:
        """Return where the joints hold after a motion was ended [rad or m].

        That is where they were commanded to be: a loaded joint hangs below, and would
        sink by that much at every end if it held where it is. A joint that has left
        its path tolerance is stopped by something, and holds where it is.
        """
        held, errors = [*self.tracking.positions], self._errors
        self.splines.compare()
        for index, segment in enumerate(self._active):
            is_watched = segment.goal is not None
            bounds = segment.tolerances.path if is_watched else self._path_bounds[index]
            if bounds.violation(errors.positions[index], errors.velocities[index]):
                held[index] = self.tracking.memory.positions[index]
        return held

    @override
    def load(self, now: float) -> None:
        """Load the segments that are active until the next segment of a joint."""
        self._active = active = []
        self.load_time = self.path_end = inf
        self.rests = False
        for index, segments in enumerate(self._trajectory):
            position = find_segment(segments, now) or 0
            segment = segments[position]
            active.append(segment)
            self.splines.load(index, segment.spline.splines)
            is_watched = segment.goal is not None
            self.tracking.set_bounds(
                index, segment.tolerances.path if is_watched else None
            )
            self.path_end = min(self.path_end, segment.end_time)
            if position + 1 < len(segments):
                following = segments[position + 1].start_time
                self.load_time = min(self.load_time, following)
        self.begin = active[0].start_time
        self.times_from_start[0] = active[0].spline.time_from_start


def _timely(
    planned: SegmentTrajectory, current: SegmentTrajectory, now: float
) -> SegmentTrajectory:
    """Return `planned` with late bridges starting at the present desired states.

    A bridge that should have begun before `now` was planned from a state that the
    joints have left since; to follow it would make the desired state jump.
    """
    result: SegmentTrajectory = []
    for segments, executed in zip(planned, current, strict=True):
        index = find_segment(segments, now)
        bridge = None if index is None else segments[index]
        if (
            index is None
            or bridge is None
            or not bridge.is_bridge
            or not bridge.start_time < now < bridge.end_time
        ):
            result.append(segments)
            continue
        position, velocity, acceleration = sample_segments(executed, now)
        here = PosVelAccState([position], [velocity], [acceleration])
        late = bridge.starting_at(now, here)
        result.append([*segments[:index], late, *segments[index + 1 :]])
    return result
