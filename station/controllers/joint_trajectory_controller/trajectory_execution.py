"""Execute a trajectory in time: plan requests, sample, supervise the goal.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller_impl.h.
"""

import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from station.controllers.joint_trajectory_controller.goal_supervision import (
    GoalSupervision,
    JointErrors,
)
from station.controllers.joint_trajectory_controller.request_limits import (
    check_duration,
    check_positions,
    check_segment_velocity,
)
from station.controllers.joint_trajectory_controller.speed_scaling import SpeedScaling
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.errors import InvalidTrajectoryError
from station.core.numerics.angles import shortest_angular_distance
from station.core.ports.goal import Goal, GoalResult, GoalStatus
from station.core.trajectory import (
    JointTolerances,
    JointTrajectory,
    JointTrajectorySegment,
    PosVelAccState,
    SegmentTrajectory,
    TrajectoryOptions,
    check_joint_names,
    find_segment,
    hold_trajectory,
    init_joint_trajectory,
    sample_segments,
    stop_trajectory,
)
from station.core.trajectory.ros_time import to_nanoseconds, to_seconds

_STANDSTILL = 1e-6
"""Speed scaling below which a trajectory counts as paused."""
_KEPT = 8
"""Number of replaced trajectories kept until a planning thread frees them."""


@dataclass(frozen=True, slots=True)
class _Moment:
    """The time of one cycle, replaced as a whole so that any thread may read it.

    Attributes:
        time: Station time [s].
        period: Time since the previous cycle [s].
        uptime: Trajectory time [ns]: integral of the speed scaling over real time.
    """

    time: float = 0.0
    period: float = 0.0
    uptime: int = 0


@dataclass(frozen=True, slots=True)
class _Request:
    """A planned trajectory that the control thread has yet to take up.

    Attributes:
        trajectory: The segments of every joint; None to stop and hold.
        goal: The goal that ends with the trajectory; None for a trajectory without one.
    """

    trajectory: SegmentTrajectory | None
    goal: Goal | None


class TrajectoryExecution:
    """The trajectory that is executed, from the request to the desired states.

    `plan`, `hold` and `query` may be called from any thread; all other methods belong
    to the control thread. `plan` computes a new trajectory in the caller's thread, and
    the next cycle takes the trajectory up. Cycles that pass during the computation make
    the bridge to the new trajectory late; a late bridge is computed anew from the
    desired states in the cycle that takes the trajectory up.

    Args:
        joints: The joints.
        stop_duration: Time in which a motion is ended [s]; 0 to hold the measured
            positions at once.
        allow_partial_joints_goal: Whether a trajectory may leave joints out.
        speed: Speed scaling of the trajectory; full speed when None.

    Attributes:
        speed: Speed scaling of the trajectory.
        positions: Desired positions [rad or m], shape (n,).
        velocities: Desired velocities [rad/s or m/s], shape (n,).
        accelerations: Desired accelerations [rad/s^2 or m/s^2], shape (n,).
        errors: Desired minus measured states.
        times_from_start: Start of the first joint's segment, and the present time, both
            from the start of the trajectory [s].

    Source:
        JointTrajectoryController; differs: after a violated tolerance the joints are
        stopped and held, not moved on; only continuous joints take the shortest way in
        the error; positions beyond a joint's limits are refused, and segments that
        need more than its velocity.
    """

    def __init__(
        self,
        joints: list[JointDescription],
        *,
        stop_duration: float = 0.0,
        allow_partial_joints_goal: bool = False,
        speed: SpeedScaling | None = None,
    ) -> None:
        self._joints = joints
        self._names = [joint.name for joint in joints]
        self._wraps = [joint.type is JointType.CONTINUOUS for joint in joints]
        self._stop_duration = stop_duration
        self._allow_partial = allow_partial_joints_goal
        self.speed = SpeedScaling() if speed is None else speed
        self.positions: list[float] = []
        self.velocities: list[float] = []
        self.accelerations: list[float] = []
        self.errors = JointErrors([], [])
        self.times_from_start = (0.0, 0.0)
        self._sampled = 0.0
        self._trajectory: SegmentTrajectory = []
        self._retired: deque[SegmentTrajectory] = deque(maxlen=_KEPT)
        self._moment = _Moment()
        self._supervision = GoalSupervision(joints)
        self._requests: deque[_Request] = deque()
        self._planning = threading.Lock()

    def start(
        self, time: float, positions: list[float], velocities: list[float]
    ) -> None:
        """Hold the present positions, or come to rest if the joints move.

        Args:
            time: Station time [s].
            positions: Measured positions [rad or m], shape (n,).
            velocities: Measured velocities [rad/s or m/s], shape (n,).
        """
        size = len(self._joints)
        self.end_goals(GoalStatus.PREEMPTED, "The controller was restarted.")
        self._moment = _Moment(time)
        self.positions = positions
        self.velocities = velocities
        self.accelerations = [0.0] * size
        self._sampled = 0.0
        self.errors = JointErrors([0.0] * size, [0.0] * size)
        self._trajectory = self._resting(positions)

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
    ) -> None:
        """Plan a request and let the next cycle take it up.

        Args:
            request: The requested trajectory; without points: stop and hold.
            goal: The goal that ends with the trajectory. The request of a goal names
                the joints even when it has no points.
            tolerances: Bounds of the errors by joint, used with a goal.

        Raises:
            InvalidTrajectoryError: The request cannot be followed; nothing changed.
        """
        with self._planning:
            # Replaced trajectories are freed here, where time does not matter.
            self._retired.clear()
            if request.points:
                planned = self._planned(request, goal, tolerances)
                self._requests.append(_Request(planned, goal))
                return
            if goal is not None:
                check_joint_names(
                    request.joint_names,
                    self._names,
                    allow_partial_joints_goal=self._allow_partial,
                )
            self._requests.append(_Request(None, goal))

    def hold(self) -> None:
        """Let the next cycle end the motion and hold. Any thread; takes no lock."""
        self._requests.append(_Request(None, None))

    def advance(
        self,
        time: float,
        period: float,
        positions: list[float],
        velocities: list[float],
    ) -> None:
        """Compute the desired states and the errors of the present cycle.

        Args:
            time: Station time [s].
            period: Time since the last cycle [s], >= 0.
            positions: Measured positions [rad or m], shape (n,).
            velocities: Measured velocities [rad/s or m/s], shape (n,).
        """
        passed = self.speed.advance(period)
        uptime = self._moment.uptime + to_nanoseconds(passed)
        self._moment = _Moment(time, period, uptime)
        now = to_seconds(uptime)
        while self._requests:
            # A request stays queued until it is followed, so that a thread that plans
            # in between continues from it (see `_latest_trajectory`).
            self._take_up(self._requests[0], now, positions)
            self._requests.popleft()
        goal = self._supervision.goal
        if goal is not None and goal.cancel_requested:
            self._supervision.end(GoalStatus.PREEMPTED, "The goal was cancelled.")
            self._follow(self._resting(positions))
        active = self._sample(now, positions, velocities)
        if self._supervision.check(active, self._trajectory, self.errors, now):
            self._follow(self._resting(positions))

    def query(self, time: float) -> PosVelAccState:
        """Return the desired state at a past or future time. Any thread.

        The present speed scaling is assumed for all times.

        Args:
            time: Station time [s].

        Raises:
            InvalidTrajectoryError: `time` is before the trajectory being executed.
        """
        moment, trajectory, factor = self._moment, self._trajectory, self.speed.factor
        when = to_seconds(moment.uptime) + factor * (time - moment.time)
        states = []
        for segments in trajectory:
            if find_segment(segments, when) is None:
                raise InvalidTrajectoryError(
                    f"The time {time} s is before the trajectory being executed.",
                    remedy=f"Ask for a later time; now it is {moment.time} s.",
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
    ) -> SegmentTrajectory:
        moment = self._moment
        check_duration(request, moment.time)
        current = self._latest_trajectory()
        following = moment.uptime + to_nanoseconds(moment.period * self.speed.factor)
        planned = init_joint_trajectory(
            request,
            moment.time + moment.period,
            TrajectoryOptions(
                current=current,
                joint_names=self._names,
                angle_wraparound=self._wraps,
                other_time_base=to_seconds(following),
                allow_partial_joints_goal=self._allow_partial,
                goal=goal,
                tolerances=tolerances,
            ),
        )
        check_positions(request, self._joints)
        self._check_velocities(planned, current)
        return planned

    def _latest_trajectory(self) -> SegmentTrajectory:
        """Return the trajectory that is executed after all queued requests."""
        try:
            latest = self._requests[-1].trajectory
        except IndexError:
            return self._trajectory
        if latest is None:  # After a stop nothing of the present trajectory goes on.
            return hold_trajectory(self._sampled, self.positions)
        return latest

    def _check_velocities(
        self, planned: SegmentTrajectory, current: SegmentTrajectory
    ) -> None:
        """Refuse new segments that are too fast for their joints.

        A trajectory that starts far from where the joints are has such segments.

        Raises:
            InvalidTrajectoryError: A segment is too fast.
        """
        for joint, segments, before in zip(self._joints, planned, current, strict=True):
            # Segments of the present trajectory have been checked before.
            known = {id(segment.spline) for segment in before}
            for segment in segments:
                if id(segment.spline) not in known:
                    check_segment_velocity(joint, segment)

    def _take_up(self, request: _Request, now: float, positions: list[float]) -> None:
        if request.trajectory is None:
            self._follow(self._resting(positions, request.goal))
        else:
            self._follow(_timely(request.trajectory, self._trajectory, now))
        self._supervision.begin(request.goal, now, self._trajectory)

    def _follow(self, trajectory: SegmentTrajectory) -> None:
        """Execute `trajectory` from now on; `plan` frees the old trajectory."""
        # To free a long trajectory takes milliseconds, which no cycle has.
        self._retired.append(self._trajectory)
        self._trajectory = trajectory

    def _resting(
        self, positions: list[float], goal: Goal | None = None
    ) -> SegmentTrajectory:
        """Return a trajectory that ends the motion, from the present cycle on.

        A stop ramp begins at the last desired state, so that the motion is continuous
        in this cycle.
        """
        now = to_seconds(self._moment.uptime)
        if self._stop_duration == 0.0:
            return hold_trajectory(now, positions, goal)
        now = self._sampled
        factor = self.speed.factor
        if factor < _STANDSTILL:
            return hold_trajectory(now, self.positions, goal)
        # `stop_duration` is real time, while the ramp runs in trajectory time.
        moving = [
            (position, velocity / factor)
            for position, velocity in zip(self.positions, self.velocities, strict=True)
        ]
        return stop_trajectory(now, self._stop_duration * factor, moving, goal)

    def _sample(
        self, now: float, measured: list[float], velocities: list[float]
    ) -> list[JointTrajectorySegment]:
        """Set desired states and errors; return the active segment of each joint."""
        active: list[JointTrajectorySegment] = []
        wanted, rates, accelerations = [], [], []
        factor, rate = self.speed.factor, self.speed.rate
        for segments in self._trajectory:
            segment = segments[find_segment(segments, now) or 0]
            active.append(segment)
            position, velocity, acceleration = segment.spline.sample_dimension(now)
            wanted.append(position)
            rates.append(velocity)
            accelerations.append(acceleration * factor * factor + velocity * rate)
        if active:
            begun = active[0].spline.time_from_start
            self.times_from_start = (begun, now - active[0].start_time + begun)
        self._sampled = now
        self.positions = wanted
        self.velocities = [velocity * factor for velocity in rates]
        self.accelerations = accelerations
        errors = [d - a for d, a in zip(wanted, measured, strict=True)]
        for index, wraps in enumerate(self._wraps):
            if wraps:
                errors[index] = shortest_angular_distance(
                    measured[index], wanted[index]
                )
        rate_errors = [d - a for d, a in zip(self.velocities, velocities, strict=True)]
        self.errors = JointErrors(errors, rate_errors)
        return active


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
