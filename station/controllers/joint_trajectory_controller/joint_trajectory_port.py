"""Trajectories without a goal, and queries of the desired state."""

from collections.abc import Callable, Mapping

from typing_extensions import override

from station.controllers.joint_trajectory_controller.follow_joint_trajectory_goal import (  # noqa: E501
    parse_trajectory,
)
from station.controllers.joint_trajectory_controller.trajectory_execution import (
    TrajectoryExecution,
)
from station.core.errors import ControllerStateError
from station.core.ports.receipt import Receipt
from station.core.trajectory import PosVelAccState
from station.core.trajectory.trajectory_port import TrajectoryPort


class JointTrajectoryPort(TrajectoryPort):
    """The topic `command` and the service `query_state` of the original.

    Args:
        execution: Plans and executes the trajectories.
        is_running: Returns whether the controller is running.
    """

    def __init__(
        self, execution: TrajectoryExecution, is_running: Callable[[], bool]
    ) -> None:
        self._execution = execution
        self._is_running = is_running

    @override
    def follow(
        self, request: Mapping[str, object], receipt: Receipt | None = None
    ) -> None:
        """Replace the trajectory being executed.

        Args:
            request: See `parse_trajectory`; without points: stop and hold.
            receipt: Where the cycle is noted that takes the trajectory up.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: The trajectory is malformed or cannot be followed.
        """
        trajectory = parse_trajectory(request)
        self._check_running()
        self._execution.plan(trajectory, receipt=receipt)

    @override
    def hold(self, receipt: Receipt | None = None) -> None:
        self._execution.hold(receipt)

    @override
    def query_state(self, time: float) -> PosVelAccState:
        """Return the desired state of the joints at a station time [s].

        Raises:
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: `time` is before the executed trajectory.
        """
        self._check_running()
        return self._execution.query(time)

    def _check_running(self) -> None:
        if not self._is_running():
            raise ControllerStateError(
                "The controller is not running; it has no trajectory.",
                remedy="Start the controller first.",
            )
