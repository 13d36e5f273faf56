"""Execute a trajectory in time: sample it, supervise its goal, command the joints.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller_impl.h.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import inf

from station.controllers.set_point_controller import CommandLaw, ControlledJoints
from station.core.control.sample_columns import SampleColumns
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import declare_number
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.hardware.interfaces import JointStateGroup
from station.core.numerics.joint_errors import CONTINUOUS, PLAIN, JointErrors
from station.core.parameters import Parameters
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import Goal, GoalResult, GoalStatus
from station.core.trajectory import (
    JointTrajectorySegment,
    PosVelAccState,
    SegmentTrajectory,
    StateTolerances,
    braking_trajectory,
    find_segment,
    hold_trajectory,
    sample_segments,
    stop_trajectory,
)
from station.core.trajectory.ros_time import to_nanoseconds, to_seconds, uptime_seconds
from station.core.trajectory.splines import SPLINE_SIZE, sample_splines
from station.memory.doubles import Doubles, Storage, own_zeros, zeros

_INF: float = inf
_STANDSTILL = 1e-6
"""Speed scaling below which a trajectory counts as paused."""
_KEPT = 8
"""Number of replaced trajectories kept until a planning thread frees them."""
SPEED_SCALING = declare_number(
    "speed_scaling",
    "speed of the executed trajectory; 0 pauses",
    1.0,
    minimum=0.0,
    maximum=1.0,
)
"""The factor of the speed, which is a run-time parameter, too."""
_RAMP = declare_number(
    "speed_scaling_ramp", "time from standstill to full speed", 0.5, "s", minimum=0.0
)
SPEED_PARAMETERS = (SPEED_SCALING, _RAMP)
"""The parameters of the speed scaling."""


class ErrorCode(IntEnum):
    """Error codes in the result of the action, with the numbers of the original."""

    SUCCESSFUL = 0
    INVALID_GOAL = -1
    INVALID_JOINTS = -2
    OLD_HEADER_TIMESTAMP = -3
    PATH_TOLERANCE_VIOLATED = -4
    GOAL_TOLERANCE_VIOLATED = -5


class SpeedScaling:
    """The rate of a trajectory's time; the factor changes at a limited rate.

    Args:
        target: The factor to reach, 0 to 1, and the first factor.
        ramp_time: Time from standstill to full speed [s], >= 0.

    Attributes:
        target: As given.
        factor: Time of the trajectory that passes per real time.
        rate: Rate at which the factor changes [1/s].
        tunables: The target as the run-time parameter `speed_scaling`.
    """

    def __init__(self, target: float = 1.0, ramp_time: float = 0.5) -> None:
        self.target = target
        self.ramp_time = ramp_time
        self.factor = target
        self.rate = 0.0
        text = "speed of the trajectory; 0 pauses, 1 is as planned"
        self.tunables = Tunables(
            {SPEED_SCALING.name: Tunable("", 0.0, 1.0, text)},
            {SPEED_SCALING.name: target},
            apply=self._set_target,
        )

    @classmethod
    def from_parameters(cls, params: Parameters) -> "SpeedScaling":
        """Return the scaling that `speed_scaling` and `speed_scaling_ramp` describe.

        Args:
            params: The controller's namespace.

        Raises:
            ParameterError: A parameter is out of its range.
        """
        return cls(SPEED_SCALING.read_float(params), _RAMP.read_float(params))

    def advance(self, period: float) -> float:
        """Move the factor towards its target; return the trajectory time passed [s].

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        before = self.factor
        if before == self.target:
            self.rate = 0.0
            return period * before
        step = period / self.ramp_time if self.ramp_time > 0.0 else 1.0
        difference = self.target - before
        if abs(difference) <= step:
            self.factor = self.target
        else:
            self.factor = before + (step if difference > 0.0 else -step)
        self.rate = (self.factor - before) / period if period > 0.0 else 0.0
        return period * 0.5 * (before + self.factor)

    def _set_target(self, values: Mapping[str, float]) -> None:
        self.target = values[SPEED_SCALING.name]


class JointTracking:
    """The states of n joints as doubles, always in the same memory. Control thread.

    Args:
        joints: The joints.
        group: Their handles, in the same order.

    Attributes:
        memory: Measured positions and velocities, and the commands.
        desired: Desired positions, velocities and accelerations one after the other,
            shape (3 n,).
        positions: Desired positions [rad or m], shape (n,), a part of `desired`.
        velocities: Desired velocities [rad/s or m/s], shape (n,).
        accelerations: Desired accelerations [rad/s^2 or m/s^2], shape (n,).
        errors: Desired minus measured positions [rad or m], shape (n,); those of
            continuous joints are the shorter ways round.
        rate_errors: Desired minus measured velocities [rad/s or m/s], shape (n,).
    """

    def __init__(self, joints: list[JointDescription], group: JointStateGroup) -> None:
        size = len(joints)
        self.memory = ControlledJoints(group)
        self.size = size
        self.desired = zeros(3 * size)
        self._states = self.desired
        self.positions: Doubles = self.desired[:size]
        self.velocities: Doubles = self.desired[size : 2 * size]
        self.accelerations: Doubles = self.desired[2 * size :]
        self.errors, self.rate_errors = zeros(size), zeros(size)
        memory = self.memory
        self._position = JointErrors(self.positions, memory.positions, self.errors)
        self._velocity = JointErrors(
            self.velocities, memory.velocities, self.rate_errors
        )
        self._splines = own_zeros(SPLINE_SIZE * size)
        # The bounds of zero that the comparisons start with are none of these.
        self._bounds: list[StateTolerances | None] = [StateTolerances()] * size
        for index, joint in enumerate(joints):
            wrapping = CONTINUOUS if joint.type is JointType.CONTINUOUS else PLAIN
            self._position.set_wrapping(index, wrapping, joint.lower, joint.upper)

    def set_bounds(self, index: int, bounds: StateTolerances | None) -> None:
        """Set the errors that count as too large; None for no bounds.

        Args:
            index: Index of the joint.
            bounds: Largest errors of position and velocity.
        """
        if bounds is self._bounds[index]:
            return
        self._bounds[index] = bounds
        position, velocity, _ = (bounds or StateTolerances()).limits()
        self._position.set_bound(index, position)
        self._velocity.set_bound(index, velocity)

    def load_spline(self, k: int, spline: Storage) -> None:
        """Let joint `k` follow a spline.

        Args:
            k: Index of the joint.
            spline: Its eight numbers, see `sample_splines`.
        """
        for i in range(8):
            self._splines[8 * k + i] = spline[i]

    def follow_splines(self, time: float, factor: float, rate: float) -> bool:
        """Compute the desired states and the errors.

        Args:
            time: Time of the splines [s].
            factor: Time of the splines that passes per real time.
            rate: Rate at which the factor changes [1/s].

        Returns:
            Whether all splines rest at their ends.
        """
        is_over = sample_splines(self._splines, time, self._states)
        if factor != 1.0 or rate != 0.0:
            states, n = self._states, self.size
            for k in range(n):
                velocity = states[n + k]
                acceleration = states[n + n + k]
                states[n + n + k] = acceleration * factor * factor + velocity * rate
                states[n + k] = velocity * factor
        self.compare_states()
        return is_over

    def compare_states(self) -> None:
        """Compute the errors only."""
        self._position.compare()
        self._velocity.compare()

    def exceeds_bounds(self) -> bool:
        """Return whether an error is larger than its bound."""
        return self._position.exceeds() or self._velocity.exceeds()

    def violation(
        self, index: int, bounds: StateTolerances
    ) -> tuple[str, float, float] | None:
        """Return the first error of a joint that is too large; see `StateTolerances`.

        Args:
            index: Index of the joint.
            bounds: Largest errors.
        """
        return bounds.violation(self.errors[index], self.rate_errors[index])


class GoalSupervision:
    """Holds the active goal until it succeeds, fails or is replaced.

    Control thread only.

    Args:
        joints: The joints.
        tracking: Their errors.

    Attributes:
        goal: The active goal; None when there is none.
    """

    def __init__(self, joints: list[JointDescription], tracking: JointTracking) -> None:
        self.goal: Goal | None = None
        self._joints = joints
        self._tracking = tracking
        self._reached: set[int] = set()
        self._start = 0.0
        self._end = 0.0

    def begin_goal(
        self, goal: Goal | None, now: float, trajectory: SegmentTrajectory
    ) -> None:
        """Make `goal` the active goal; the previous goal is preempted.

        Args:
            goal: The new goal; None for a trajectory without a goal.
            now: Trajectory time [s].
            trajectory: The trajectory that is executed from now on.
        """
        self.end_goal(GoalStatus.PREEMPTED, "Another trajectory replaced this goal.")
        self.goal = goal
        self._reached.clear()
        self._start = now
        # Compiled, a negative index is none: the last segment is the one at len - 1.
        self._end = max(each[len(each) - 1].end_time for each in trajectory)
        if goal is not None and not goal.is_final():
            goal.status = GoalStatus.ACTIVE

    def end_goal(self, status: GoalStatus, reason: str) -> None:
        """End the active goal, if there is one, for a reason outside of its tolerances.

        Args:
            status: The final status.
            reason: The reason in one sentence.
        """
        if self.goal is not None:
            self.goal.finish(status, GoalResult(0, reason))
            self.goal = None

    def note_progress(self, goal: Goal, now: float) -> None:
        """Report how much of the time of the active goal has passed.

        Args:
            goal: The active goal.
            now: Trajectory time [s].
        """
        duration = self._end - self._start
        passed = (now - self._start) / duration if duration > 0.0 else 1.0
        goal.progress = passed if passed < 1.0 else 1.0

    def check_goal(
        self,
        active: list[JointTrajectorySegment],
        trajectory: SegmentTrajectory,
        now: float,
    ) -> bool:
        """Compare the errors with the tolerances; return whether the goal was aborted.

        Args:
            active: The present segment of each joint.
            trajectory: All segments.
            now: Trajectory time [s].
        """
        goal = self.goal
        if goal is None:
            return False
        self.note_progress(goal, now)
        for index, segment in enumerate(active):
            if segment.goal is not goal:
                continue
            result = None
            segments = trajectory[index]
            if now < segment.end_time or segment is segments[len(segments) - 1]:
                result = self._violation(index, segment, now)
            if result is not None:
                goal.finish(GoalStatus.ABORTED, result)
                self.goal = None
                return True
        if len(self._reached) == len(active):
            goal.progress = 1.0
            goal.finish(GoalStatus.SUCCEEDED, GoalResult())
            self.goal = None
        return False

    def _violation(
        self, index: int, segment: JointTrajectorySegment, now: float
    ) -> GoalResult | None:
        tolerances = segment.tolerances
        is_on_path = now < segment.end_time
        bounds = tolerances.path if is_on_path else tolerances.goal
        violation = self._tracking.violation(index, bounds)
        if is_on_path and violation is not None:
            code = ErrorCode.PATH_TOLERANCE_VIOLATED
            return self._result(index, violation, now, code, "on its path")
        if is_on_path:
            return None
        if violation is None:
            self._reached.add(index)
            return None
        if now < segment.end_time + tolerances.goal_time:
            return None
        code = ErrorCode.GOAL_TOLERANCE_VIOLATED
        return self._result(index, violation, now, code, "at its goal")

    def _result(
        self,
        index: int,
        violation: tuple[str, float, float],
        now: float,
        code: ErrorCode,
        where: str,
    ) -> GoalResult:
        joint = self._joints[index]
        quantity, error, tolerance = violation
        unit = "m" if joint.is_linear() else "rad"
        unit = {"velocity": f"{unit}/s", "acceleration": f"{unit}/s^2"}.get(
            quantity, unit
        )
        after = now - self._start
        return GoalResult(
            int(code),
            f"Joint '{joint.name}' has a {quantity} error of {error:.6g} {unit} "
            f"{where} after {after:.3f} s; allowed are {tolerance:.6g} {unit}.",
            {
                "joint": joint.name,
                "quantity": quantity,
                "error": error,
                "tolerance": tolerance,
                "time": after,
            },
        )


@dataclass(frozen=True, slots=True)
class Request:
    """A planned trajectory that the control thread has yet to take up.

    Attributes:
        trajectory: The segments of every joint; None to stop and hold.
        is_void: Whether earlier commands count no longer, so that the joints hold
            where they are.
        goal: The goal that ends with the trajectory; None for a trajectory without one.
        ticket: Notes the cycle that takes the request.
    """

    trajectory: SegmentTrajectory | None
    goal: Goal | None
    ticket: CommandTicket | None = None
    is_void: bool = False


class TrajectoryExecution:
    """The trajectory that is executed, from a planned request to the desired states.

    Any thread may call `hold`, append to `requests` and read the attributes; all other
    methods belong to the control thread. Cycles that pass while a trajectory is planned
    make the bridge to it late; a late bridge is computed anew from the desired states
    in the cycle that takes the trajectory up. Times of trajectories are in whole
    nanoseconds, so that sums of times compare exactly.

    Args:
        joints: The joints.
        tracking: Their measured states; receives desired states and errors.
        stop_duration: Time in which a motion is ended [s]; 0 to hold at once.
        decelerations: How every joint is brought to rest instead [rad/s^2 or m/s^2],
            > 0; empty for `stop_duration`.
        path_bounds: Path tolerances of trajectories without a goal, shape (n,); None
            for none.
        speed: Speed scaling of the trajectory; full speed when None.

    Attributes:
        tracking: As given.
        requests: Requests that wait for a cycle, oldest first.
        trajectory: The trajectory that is executed.
        retired: Replaced trajectories; the planner frees them.
        moment: Station time [s], time since the cycle before [s], and trajectory time
            [ns]: the integral of the speed over real time. One object, replaced as a
            whole, so that any thread may read it.
        sampled: Trajectory time of the states that were sampled last [s].
        times_from_start: Start of the first joint's segment, and the present time, both
            from the start of the trajectory [s], shape (2,); always the same memory.

    Source:
        JointTrajectoryController; differs: after a violated tolerance the joints are
        stopped and held, not moved on; a stopped joint holds what was commanded, not
        what is measured, unless it has left its path tolerance; only continuous joints
        take the shortest way in the error, and a position beyond half a turn keeps its
        whole turns; a moving joint goes on without a step of its velocity; positions
        beyond a joint's limits are refused, and segments that are too fast or lead
        beyond the limits.
    """

    def __init__(
        self,
        joints: list[JointDescription],
        tracking: JointTracking,
        *,
        stop_duration: float = 0.0,
        decelerations: Sequence[float] = (),
        path_bounds: Sequence[StateTolerances] | None = None,
        speed: SpeedScaling | None = None,
    ) -> None:
        self._names = [joint.name for joint in joints]
        self._stop_duration = stop_duration
        self._decelerations = decelerations
        self._path_bounds = path_bounds or [StateTolerances()] * len(joints)
        self.speed = SpeedScaling() if speed is None else speed
        self.tracking = tracking
        self.moment: tuple[float, float, int] = (0.0, 0.0, 0)
        # The trajectory time [ns], and what passes of it per cycle [s, ns].
        self._uptime = 0
        self._passed, self._passed_ns = 0.0, 0
        self.sampled = 0.0
        # When the next segments are to be loaded, when the first of those that are
        # loaded ends, and when that of the first joint has begun [s].
        self._load_time = self._path_end = -inf
        self._begin = 0.0
        # Whether all joints rest at the ends of their last segments.
        self._rests = False
        self.times_from_start = zeros(2)
        self._times = self.times_from_start
        # The active segment of each joint.
        self._active: list[JointTrajectorySegment] = []
        self.trajectory: SegmentTrajectory = []
        self.retired: deque[SegmentTrajectory] = deque(maxlen=_KEPT)
        self._supervision = GoalSupervision(joints, tracking)
        self.requests: deque[Request] = deque()

    def start(self, time: float) -> None:
        """Hold the measured positions, or come to rest if the joints move.

        Args:
            time: Station time [s].
        """
        tracking, memory = self.tracking, self.tracking.memory
        self.end_goals(GoalStatus.PREEMPTED, "The controller was restarted.")
        self._uptime = 0
        self.moment = (time, 0.0, 0)
        tracking.positions[:] = memory.positions
        tracking.velocities[:] = memory.velocities
        tracking.accelerations[:] = zeros(len(self._names))
        self.sampled = 0.0
        self.trajectory = self._resting(is_void=True)
        self._load_time = -inf

    def end_goals(self, status: GoalStatus, reason: str) -> None:
        """End the active goal and every waiting goal for good.

        Args:
            status: The final status of the goals.
            reason: The reason in one sentence.
        """
        self._supervision.end_goal(status, reason)
        while self.requests:
            waiting = self.requests.popleft().goal
            if waiting is not None:
                waiting.finish(status, GoalResult(0, reason))

    def hold(
        self, ticket: CommandTicket | None = None, *, is_void: bool = False
    ) -> None:
        """Let the next cycle end the motion and hold. Any thread; takes no lock.

        Args:
            ticket: Notes the cycle that takes the request.
            is_void: Whether earlier commands count no longer, because of a stop, a
                reset or a recovery: the joints hold where they are.
        """
        self.requests.append(Request(None, None, ticket, is_void))

    def advance(self, time: float, period: float) -> None:
        """Compute the desired states and the errors of the present cycle.

        Args:
            time: Station time [s].
            period: Time since the last cycle [s], >= 0.
        """
        passed = self.speed.advance(period)
        if passed != self._passed:
            self._passed = passed
            self._passed_ns = to_nanoseconds(passed)
        self._uptime += self._passed_ns
        self.moment = (time, period, self._uptime)
        now = uptime_seconds(self._uptime)
        while len(self.requests) > 0:
            # A request stays queued until it is followed, so that a thread that plans
            # in between continues from it.
            self._take_up(self.requests[0], now)
            self.requests.popleft()
        supervision = self._supervision
        goal = supervision.goal
        if goal is not None and goal.cancel_requested:
            supervision.end_goal(GoalStatus.PREEMPTED, goal.cancel_reason)
            self._follow(self._resting())
            goal = None
        self._sample_states(now)
        if goal is None:
            return
        if now < self._path_end and not self.tracking.exceeds_bounds():
            supervision.note_progress(goal, now)
        elif supervision.check_goal(self._active, self.trajectory, now):
            self._follow(self._resting())

    def _sample_states(self, now: float) -> None:
        """Compute desired states and errors at a trajectory time [s]."""
        if now >= self._load_time:
            self._load_segments(now)
        self._times[1] = now - self._begin + self._times[0]
        self.sampled = now
        if self._rests:
            self.tracking.compare_states()
            return
        speed = self.speed
        if self.tracking.follow_splines(now, speed.factor, speed.rate):
            self._rests = self._load_time == _INF

    def _take_up(self, request: Request, now: float) -> None:
        if request.trajectory is None:
            self._follow(self._resting(request.goal, is_void=request.is_void))
        else:
            self._follow(_timely(request.trajectory, self.trajectory, now))
        self._supervision.begin_goal(request.goal, now, self.trajectory)
        if request.ticket is not None:
            request.ticket.accept()

    def _follow(self, trajectory: SegmentTrajectory) -> None:
        """Execute `trajectory` from now on; a planner frees the old one."""
        # To free a long trajectory takes milliseconds, which no cycle has.
        self.retired.append(self.trajectory)
        self.trajectory = trajectory
        self._load_time = -inf

    def _resting(
        self, goal: Goal | None = None, *, is_void: bool = False
    ) -> SegmentTrajectory:
        """Return a trajectory that ends the motion, from the present cycle on.

        A stop ramp begins at the last desired state, so that the motion is continuous
        in this cycle.
        """
        now = to_seconds(self.moment[2])
        tracking = self.tracking
        if self._stop_duration == 0.0 and not self._decelerations:
            held = tracking.memory.positions if is_void else self._held_positions()
            return hold_trajectory(now, held, goal)
        now = self.sampled
        factor = self.speed.factor
        if factor < _STANDSTILL:
            return hold_trajectory(now, tracking.positions, goal)
        # The stop is described in real time, while the ramp runs in trajectory time.
        states = zip(tracking.positions, tracking.velocities, strict=True)
        moving = [(position, velocity / factor) for position, velocity in states]
        if self._decelerations:
            braking = [each / factor**2 for each in self._decelerations]
            return braking_trajectory(now, braking, moving, goal)
        return stop_trajectory(now, self._stop_duration * factor, moving, goal)

    def _held_positions(self) -> list[float]:
        """Return the positions that the joints hold after an ended motion [rad or m].

        These are the commanded positions: a loaded joint hangs below them, and would
        sink by that error at every end if it held the measured position. A joint that
        has left its path tolerance is blocked, and holds the measured position.
        """
        held, tracking = [*self.tracking.positions], self.tracking
        tracking.compare_states()
        for index, segment in enumerate(self._active):
            is_watched = segment.goal is not None
            bounds = segment.tolerances.path if is_watched else self._path_bounds[index]
            if tracking.violation(index, bounds):
                held[index] = tracking.memory.positions[index]
        return held

    def _load_segments(self, now: float) -> None:
        """Load the segments that are active until the next segment of a joint."""
        self._active = active = []
        self._load_time = self._path_end = inf
        self._rests = False
        for index, segments in enumerate(self.trajectory):
            position = find_segment(segments, now) or 0
            segment = segments[position]
            active.append(segment)
            self.tracking.load_spline(index, segment.spline.splines)
            is_watched = segment.goal is not None
            self.tracking.set_bounds(
                index, segment.tolerances.path if is_watched else None
            )
            self._path_end = min(self._path_end, segment.end_time)
            if position + 1 < len(segments):
                following = segments[position + 1].start_time
                self._load_time = min(self._load_time, following)
        self._begin = active[0].start_time
        self._times[0] = active[0].spline.time_from_start


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


class TrajectoryUpdate:
    """The update of a controller that executes a trajectory.

    Args:
        execution: The trajectory.
        law: Computes the commands from the desired states and the errors.
        output: Output in a sample, shape (n,).

    Attributes:
        sampled: The sample of each cycle: its four columns, then desired velocities and
            accelerations, measured velocities, errors of velocities, and
            `times_from_start`.
    """

    def __init__(
        self, execution: TrajectoryExecution, law: CommandLaw, output: Doubles
    ) -> None:
        tracking = execution.tracking
        memory = tracking.memory
        self.execution = execution
        self.copies = memory if memory.is_copy else None
        self.law = law
        columns = (
            tracking.positions,
            memory.positions,
            tracking.errors,
            output,
            tracking.velocities,
            tracking.accelerations,
            memory.velocities,
            tracking.rate_errors,
            execution.times_from_start,
        )
        self.sampled = SampleColumns(columns)

    def command_joints(self, time: float, period: float) -> None:
        """Command the joints along the trajectory.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        if self.copies is not None:
            self.copies.read()
        self.execution.advance(time, period)
        self.law.compute_commands(period)
        if self.copies is not None:
            self.copies.write()
        self.sampled.keep(time)
