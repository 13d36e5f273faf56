"""Compare joint errors with the tolerances of a goal, and end the goal accordingly.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller_impl.h, JointTrajectoryController.update.
"""

from dataclasses import dataclass

from station.controllers.joint_trajectory_controller.follow_joint_trajectory_goal import (  # noqa: E501
    ErrorCode,
)
from station.core.description.robot_description import JointDescription
from station.core.ports.goal import Goal, GoalResult, GoalStatus
from station.core.trajectory import JointTrajectorySegment, SegmentTrajectory
from station.memory.doubles import Storage


@dataclass(frozen=True, slots=True)
class StateErrors:
    """Differences between desired and measured joint states, shape (n,) each.

    Attributes:
        positions: Desired minus measured positions [rad or m].
        velocities: Desired minus measured velocities [rad/s or m/s].
    """

    positions: Storage
    velocities: Storage


class GoalSupervision:
    """Holds the active goal until it succeeds, fails or is replaced.

    Control thread only.

    Args:
        joints: The joints.

    Attributes:
        goal: The active goal; None when there is none.
    """

    def __init__(self, joints: list[JointDescription]) -> None:
        self.goal: Goal | None = None
        self._joints = joints
        self._reached: set[int] = set()
        self._start = 0.0
        self._end = 0.0

    def begin(
        self, goal: Goal | None, now: float, trajectory: SegmentTrajectory
    ) -> None:
        """Make `goal` the active goal; the previous goal is preempted.

        Args:
            goal: The new goal; None for a trajectory without a goal.
            now: Trajectory time [s].
            trajectory: The trajectory that is executed from now on.
        """
        self.end(GoalStatus.PREEMPTED, "Another trajectory replaced this goal.")
        self.goal = goal
        self._reached.clear()
        self._start = now
        self._end = max(segments[-1].end_time for segments in trajectory)
        if goal is not None and not goal.is_final():
            goal.status = GoalStatus.ACTIVE

    def end(self, status: GoalStatus, reason: str) -> None:
        """End the active goal, if there is one, for a reason outside of its tolerances.

        Args:
            status: The final status.
            reason: The reason in one sentence.
        """
        if self.goal is not None:
            self.goal.finish(status, GoalResult(0, reason))
            self.goal = None

    def follow_progress(self, goal: Goal, now: float) -> None:
        """Report how much of the time of the active goal has passed.

        Args:
            goal: The active goal.
            now: Trajectory time [s].
        """
        duration = self._end - self._start
        passed = (now - self._start) / duration if duration > 0.0 else 1.0
        goal.progress = passed if passed < 1.0 else 1.0

    def check(
        self,
        active: list[JointTrajectorySegment],
        trajectory: SegmentTrajectory,
        errors: StateErrors,
        now: float,
    ) -> bool:
        """Compare the errors with the tolerances; return whether the goal was aborted.

        Args:
            active: The present segment of each joint.
            trajectory: All segments.
            errors: The present errors.
            now: Trajectory time [s].
        """
        goal = self.goal
        if goal is None:
            return False
        self.follow_progress(goal, now)
        for index, segment in enumerate(active):
            if segment.goal is not goal:
                continue
            result = None
            if now < segment.end_time or segment is trajectory[index][-1]:
                result = self._violation(index, segment, errors, now)
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
        self,
        index: int,
        segment: JointTrajectorySegment,
        errors: StateErrors,
        now: float,
    ) -> GoalResult | None:
        tolerances = segment.tolerances
        is_on_path = now < segment.end_time
        bounds = tolerances.path if is_on_path else tolerances.goal
        violation = bounds.violation(errors.positions[index], errors.velocities[index])
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
