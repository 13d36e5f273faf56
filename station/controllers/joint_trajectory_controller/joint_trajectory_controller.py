"""Move joints along trajectories; the base of the controllers of all interfaces.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller.h, joint_trajectory_controller_impl.h.
"""

from collections.abc import Mapping
from typing import NamedTuple, TypeVar

from typing_extensions import override

from station.controllers.forward_command_controller.joint_names import read_joint_names
from station.controllers.joint_trajectory_controller.follow_joint_trajectory_port import (  # noqa: E501
    FollowJointTrajectoryPort,
)
from station.controllers.joint_trajectory_controller.joint_trajectory_port import (
    JointTrajectoryPort,
)
from station.controllers.joint_trajectory_controller.speed_scaling import SpeedScaling
from station.controllers.joint_trajectory_controller.trajectory_execution import (
    TrajectoryExecution,
)
from station.core.control.controller import Controller, ControllerSample
from station.core.control.tunables import Tunable
from station.core.description.robot_description import (
    JointDescription,
    require_robot_description,
)
from station.core.errors import ParameterError
from station.core.hardware.interfaces import JointStateGroup
from station.core.parameters import Parameters
from station.core.ports.goal import GoalStatus
from station.core.trajectory import (
    PosVelAccState,
    read_tolerances,
)

InterfaceT = TypeVar("InterfaceT")
SPEED_SCALING = "speed_scaling"


class JointTrajectoryState(NamedTuple):
    """What was desired and measured in one cycle; lists have the shape (n,).

    Attributes:
        stamp: Station time of the cycle [s].
        desired: Desired positions, velocities and accelerations.
        actual: Measured positions and velocities.
        error: Their differences.
    """

    stamp: float
    desired: PosVelAccState
    actual: PosVelAccState
    error: PosVelAccState


class JointTrajectoryControllerBase(Controller[InterfaceT]):
    """Executes trajectories and goals; subclasses command the hardware.

    Parameters: `joints`; `constraints` with `goal_time`, `stopped_velocity_tolerance`
    and per joint `trajectory` and `goal`; `stop_trajectory_duration` [s];
    `allow_partial_joints_goal`; `speed_scaling`, 0 to 1, and `speed_scaling_ramp`, the
    time from standstill to full speed [s]. `robot_description` in this or an outer
    namespace gives types and limits of the joints. `state_publish_rate` and
    `action_monitor_rate` are accepted and not needed: every cycle's state is there.

    The run-time parameter `speed_scaling` slows the executed trajectory down, 0 pauses
    it; positions stay on the same path.

    Attributes:
        trajectory_state: What was desired and measured last, a new object each cycle;
            None before the first.
    """

    def __init__(self) -> None:
        super().__init__()
        self.joints: list[JointDescription] = []
        self.execution = TrajectoryExecution([])
        self.trajectory_state: JointTrajectoryState | None = None
        self._schema: dict[str, Tunable] = {}

    @override
    def init(self, interface: InterfaceT, params: Parameters) -> None:
        self.joint_names = read_joint_names(params)
        description = require_robot_description(params)
        self.joints = [description.joint(name) for name in self.joint_names]
        self.init_joints(interface, params)
        self.execution = TrajectoryExecution(
            self.joints,
            stop_duration=_read_duration(params, "stop_trajectory_duration", 0.0),
            allow_partial_joints_goal=params.get_bool(
                "allow_partial_joints_goal", default=False
            ),
            speed=_read_speed(params),
        )
        self.goals = FollowJointTrajectoryPort(
            self.execution,
            read_tolerances(params.namespace("constraints"), self.joint_names),
            self.is_running,
            self._state_message,
        )
        self.trajectories = JointTrajectoryPort(self.execution, self.is_running)
        self._schema = {
            **self.command_gain_schema(),
            SPEED_SCALING: Tunable(
                "", 0.0, 1.0, "speed of the trajectory; 0 pauses, 1 is as planned"
            ),
        }

    def init_joints(self, interface: InterfaceT, params: Parameters) -> None:
        """Claim the joints `self.joint_names` and read what commanding them needs.

        Args:
            interface: The robot's interface.
            params: The controller's namespace.

        Raises:
            StationError: A joint or a parameter is missing or impossible.
        """
        raise NotImplementedError

    def group(self) -> JointStateGroup:
        """Return the joints, for reading."""
        raise NotImplementedError

    def reset_command(self) -> None:
        """Forget what happened before; called when the controller starts."""

    def command(self, execution: TrajectoryExecution, period: float) -> list[float]:
        """Command the joints towards the desired states; return what was commanded.

        Args:
            execution: Desired states and errors of this cycle.
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError

    def command_gain_schema(self) -> Mapping[str, Tunable]:
        """Return the run-time parameters of the command law; none by default."""
        return {}

    def command_gains(self) -> dict[str, float]:
        """Return the present values of these parameters."""
        return {}

    def apply_command_gains(self, values: Mapping[str, float]) -> None:
        """Take over a complete set of values."""

    @override
    def starting(self, time: float) -> None:
        group = self.group()
        self.execution.start(time, group.get_positions(), group.get_velocities())
        self.reset_command()

    @override
    def stopping(self, time: float) -> None:
        """End the active goal; it never resumes."""
        self.execution.end_goals(GoalStatus.PREEMPTED, "The controller was stopped.")

    @override
    def aborting(self, time: float) -> None:
        """End the active goal; it never resumes."""
        self.execution.end_goals(GoalStatus.ABORTED, "The controller failed.")

    @override
    def update(self, time: float, period: float) -> None:
        group = self.group()
        positions, velocities = group.get_positions(), group.get_velocities()
        execution = self.execution
        execution.advance(time, period, positions, velocities)
        output = self.command(execution, period)
        desired, errors = execution.positions, execution.errors
        begun, passed = execution.times_from_start
        self.sample = ControllerSample(
            time, desired, positions, errors.positions, output
        )
        self.trajectory_state = JointTrajectoryState(
            time,
            PosVelAccState(
                desired, execution.velocities, execution.accelerations, begun
            ),
            PosVelAccState(positions, velocities, time_from_start=passed),
            PosVelAccState(
                errors.positions, errors.velocities, time_from_start=begun - passed
            ),
        )

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return what the original's topic `state` says."""
        message = self._state_message()
        return {"state": message} if message else {}

    def _state_message(self) -> dict[str, object]:
        """Return the last state; it is the feedback of goals, too."""
        state = self.trajectory_state
        if state is None:
            return {}
        return {
            "stamp": state.stamp,
            "joint_names": list(self.joint_names),
            "desired": _message(state.desired),
            "actual": _message(state.actual),
            "error": _message(state.error),
        }

    @override
    def gain_schema(self) -> Mapping[str, Tunable]:
        return self._schema

    @override
    def gains(self) -> dict[str, float]:
        return {**self.command_gains(), SPEED_SCALING: self.execution.speed.target}

    @override
    def apply_gains(self, values: Mapping[str, float]) -> None:
        self.apply_command_gains(values)
        self.execution.speed.target = values[SPEED_SCALING]


def _message(state: PosVelAccState) -> dict[str, object]:
    """Return a state like a trajectory_msgs/JointTrajectoryPoint."""
    return {
        "positions": state.position,
        "velocities": state.velocity,
        "accelerations": state.acceleration,
        "time_from_start": state.time_from_start,
    }


def _read_duration(params: Parameters, key: str, default: float) -> float:
    """Return a duration [s].

    Raises:
        ParameterError: It is no number >= 0.
    """
    duration = params.get_float(key, default)
    if duration < 0.0:
        raise ParameterError(
            f"Parameter '{params.resolve(key)}' is {duration}; it must be >= 0 s.",
            remedy="Give a time in seconds.",
            details={"parameter": params.resolve(key)},
        )
    return duration


def _read_speed(params: Parameters) -> SpeedScaling:
    """Return the speed scaling.

    Raises:
        ParameterError: A value is out of its range.
    """
    target = params.get_float(SPEED_SCALING, 1.0)
    if not 0.0 <= target <= 1.0:
        raise ParameterError(
            f"Parameter '{params.resolve(SPEED_SCALING)}' is {target}; allowed is 0 "
            "to 1.",
            remedy="Give a fraction of the planned speed.",
            details={"parameter": params.resolve(SPEED_SCALING)},
        )
    return SpeedScaling(target, _read_duration(params, "speed_scaling_ramp", 0.5))
