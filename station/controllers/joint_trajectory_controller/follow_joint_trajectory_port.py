"""The goals of a joint trajectory controller: checked and planned on arrival."""

from collections.abc import Callable, Mapping, Sequence

from typing_extensions import override

from station.controllers.joint_trajectory_controller.follow_joint_trajectory_goal import (  # noqa: E501
    error_code_of,
    parse_goal,
)
from station.controllers.joint_trajectory_controller.trajectory_execution import (
    TrajectoryExecution,
)
from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import Goal, GoalPort
from station.core.ports.receipt import Receipt
from station.core.trajectory import (
    JointTolerances,
    ToleranceRequest,
    updated_tolerances,
)


class FollowJointTrajectoryPort(GoalPort):
    """Checks goals and plans their trajectories; the controller executes them.

    Args:
        execution: Receives the planned trajectories.
        tolerances: Default bounds of the errors by joint.
        is_running: Returns whether the controller is running.
        feedback: Returns the feedback message of the active goal.

    Source:
        ros_controllers@678b92a joint_trajectory_controller_impl.h, goalCB; differs:
        tolerances for other joints are refused, not ignored.
    """

    def __init__(
        self,
        execution: TrajectoryExecution,
        tolerances: Mapping[str, JointTolerances],
        is_running: Callable[[], bool],
        feedback: Callable[[], Mapping[str, object]],
    ) -> None:
        super().__init__(is_running, feedback)
        self._execution = execution
        self._tolerances = tolerances

    @override
    def submit(
        self, request: Mapping[str, object], receipt: Receipt | None = None
    ) -> Goal:
        """Check a follow_joint_trajectory goal and let it replace the present one.

        Args:
            request: See `parse_goal`.
            receipt: Where the cycle is noted that takes the goal up.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: The goal is malformed or cannot be followed;
                `details["error_code"]` is the error code of the action's result.
        """
        try:
            return self._accept(request, receipt)
        except InvalidTrajectoryError as error:
            error.details["error_code"] = int(error_code_of(error))
            raise

    def _accept(self, request: Mapping[str, object], receipt: Receipt | None) -> Goal:
        wanted = parse_goal(request)
        self._check_tolerances([*wanted.path_tolerance, *wanted.goal_tolerance])
        goal = self.new_goal(request, receipt)
        bounds = updated_tolerances(
            self._tolerances,
            wanted.path_tolerance,
            wanted.goal_tolerance,
            wanted.goal_time_tolerance,
        )
        self._execution.plan(wanted.trajectory, goal, bounds, receipt)
        self.remember(goal)
        return goal

    def _check_tolerances(self, tolerances: Sequence[ToleranceRequest]) -> None:
        """Refuse tolerances that would have no effect.

        Raises:
            InvalidTrajectoryError: One is for a joint that the controller does not
                have, or bounds an acceleration.
        """
        for tolerance in tolerances:
            # No joint tells its acceleration; the original compares an error of 0.
            if tolerance.acceleration > 0.0:
                raise InvalidTrajectoryError(
                    f"The goal has the acceleration tolerance {tolerance.acceleration} "
                    f"for '{tolerance.name}'; joints have no measured acceleration, so "
                    "it would never be checked.",
                    remedy="Leave it out, or give a velocity tolerance.",
                    details={"joint": tolerance.name, "quantity": "acceleration"},
                )
            if tolerance.name not in self._tolerances:
                known = ", ".join(self._tolerances)
                raise InvalidTrajectoryError(
                    f"The goal has a tolerance for '{tolerance.name}'; the joints are "
                    f"{known}.",
                    remedy="Name tolerances after joints of the controller.",
                    details={"joint": tolerance.name},
                )

    @override
    def void(self, reason: str) -> None:
        """End every goal and every trajectory without a goal; the joints hold."""
        super().void(reason)
        self._execution.hold(is_void=True)
