"""Move joints along trajectories, over any joint command interface.

Source: ros_controllers@678b92a joint_trajectory_controller/
joint_trajectory_controller.h, joint_trajectory_controller_impl.h.
"""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar, NamedTuple, TypeVar

from typing_extensions import override

from station.controllers.joint_trajectory_controller.execution import (
    SPEED_PARAMETERS,
    JointTracking,
    SpeedScaling,
    TrajectoryExecution,
    TrajectoryUpdate,
)
from station.controllers.joint_trajectory_controller.goals import (
    FollowJointTrajectoryPort,
    JointTrajectoryPort,
)
from station.controllers.joint_trajectory_controller.motion_primitives import (
    MotionSequences,
)
from station.controllers.joint_trajectory_controller.planning import TrajectoryPlanner
from station.controllers.set_point_controller import (
    JOINTS,
    CommandLaw,
    DirectLaw,
    JointPidGroup,
    JointQuantity,
    PidLaw,
    pid_parameters,
    read_joint_names,
)
from station.core.control.controller import Controller, PackedSample
from station.core.control.tunables import Tunables
from station.core.declared_parameter import (
    EACH_JOINT,
    DeclaredParameter,
    declare_boolean,
    declare_number,
    declare_string,
)
from station.core.description.robot_description import (
    JointDescription,
    chain_to,
    ends_of_chain,
    require_robot_description,
)
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    JointGroup,
    JointStateGroup,
    PositionJointInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.resource_manager import interface_type_name
from station.core.numerics.arm_chain import JointChain
from station.core.numerics.pid import PidGains
from station.core.parameters import Parameters
from station.core.ports.goal import GoalStatus
from station.core.trajectory import (
    TOLERANCE_PARAMETERS,
    PosVelAccState,
    read_tolerances,
)
from station.memory.direct_calls import call_directly
from station.memory.doubles import Doubles, doubles

_VELOCITY_FF = declare_number(
    f"velocity_ff/{EACH_JOINT}",
    "factor with which the desired velocity is added to the command",
    0.0,
    "command s/rad",
)


class HardwareInterfaceAdapter:
    """Joints that are claimed for a trajectory, and the law that commands them.

    Args:
        tracking: Desired and measured states of the joints.
        law: Commands the joints towards the desired states.
        output: Output in a sample, shape (n,), always the same memory; None
            for the commands of `tracking`.
        pids: The PIDs of the law; None if it has none.

    Attributes:
        tracking: As given.
        law: As given.
        output: As given.
        tunables: Run-time parameters of the law.
    """

    def __init__(
        self,
        tracking: JointTracking,
        law: CommandLaw,
        *,
        output: Doubles | None = None,
        pids: JointPidGroup | None = None,
    ) -> None:
        self.tracking = tracking
        self.law = law
        self.output = tracking.memory.commands if output is None else output
        self.tunables = Tunables() if pids is None else pids.tunables
        self._pids = pids

    def reset(self) -> None:
        """Forget earlier errors; called when the controller starts."""
        if self._pids is not None:
            self._pids.reset()


class DesiredStateLaw(CommandLaw):
    """Commands desired positions and velocities, and accelerations where they count.

    Args:
        tracking: Desired states of the joints.
        handles: Handles of the joints; their type decides about accelerations.
    """

    def __init__(
        self,
        tracking: JointTracking,
        handles: Sequence[PosVelJointHandle | PosVelAccJointHandle],
    ) -> None:
        self._columns = [tracking.positions, tracking.velocities]
        if isinstance(handles[0], PosVelAccJointHandle):
            self._columns.append(tracking.accelerations)
        self._set_commands: list[Callable[..., None]] = [
            handle.set_command for handle in handles
        ]

    @override
    def compute_commands(self, period: float) -> None:
        """Command the desired states."""
        numbers = zip(*self._columns, strict=True)
        for set_command, state in zip(self._set_commands, numbers, strict=True):
            set_command(*state)


_PID_COMMANDS: dict[type, JointQuantity] = {
    VelocityJointInterface: JointQuantity.VELOCITY,
    EffortJointInterface: JointQuantity.EFFORT,
}
"""Quantity that PIDs compute, by the type of the interface."""


def adapter_parameters(interface: type) -> tuple[DeclaredParameter, ...]:
    """Return the parameters that the adapter for an interface reads.

    Args:
        interface: Type of the interface.
    """
    command = _PID_COMMANDS.get(interface)
    if command is None:
        return ()
    rate = "" if command is JointQuantity.VELOCITY else "Nm s/rad"
    pid = pid_parameters(error=JointQuantity.POSITION, command=command)
    return (*pid, replace(_VELOCITY_FF, unit=rate))


def adapter_for(
    interface: object, joints: list[JointDescription], params: Parameters
) -> HardwareInterfaceAdapter:
    """Claim joints of an interface and return the adapter for its type.

    Args:
        interface: One of the robot's joint command interfaces.
        joints: The joints.
        params: The controller's namespace.

    Raises:
        ControllerLoadError: There is no adapter for the type of `interface`.
        ParameterError: A joint has no gains, or a parameter is not allowed.
        ResourceNotFoundError: The robot has no joint of that name.
    """
    match interface:
        case PositionJointInterface():
            handles = [interface.get_handle(joint.name) for joint in joints]
            tracking = JointTracking(joints, JointGroup(handles))
            law = DirectLaw(tracking.positions, tracking.memory.commands)
            return HardwareInterfaceAdapter(tracking, law)
        case VelocityJointInterface() | EffortJointInterface():
            return _closed_loop_adapter(interface, joints, params)
        case PosVelJointInterface() | PosVelAccJointInterface():
            states = [interface.get_handle(joint.name) for joint in joints]
            tracking = JointTracking(joints, JointStateGroup(states))
            return HardwareInterfaceAdapter(
                tracking, DesiredStateLaw(tracking, states), output=tracking.positions
            )
    raise ControllerLoadError(
        "No trajectory can be commanded over "
        f"'{interface_type_name(type(interface))}'.",
        remedy="Use a joint command interface, or override `make_adapter`.",
    )


def _closed_loop_adapter(
    interface: JointCommandInterface, joints: list[JointDescription], params: Parameters
) -> HardwareInterfaceAdapter:
    """Command `velocity_ff` times the desired velocity plus the output of a PID.

    Parameters: the gains of every joint, see `PidGains.of_joints`; and
    `velocity_ff/<joint>`, 0 by default.

    Source:
        ClosedLoopHardwareInterfaceAdapter; differs: missing gains are refused when the
        controller is loaded.
    """
    names = [joint.name for joint in joints]
    tracking = JointTracking(joints, JointGroup([*map(interface.get_handle, names)]))
    pids = JointPidGroup(
        joints,
        PidGains.of_joints(params, names),
        places=PidGains.places(params, names),
        error=JointQuantity.POSITION,
        command=_PID_COMMANDS[type(interface)],
        commands=tracking.memory.commands,
        errors=tracking.errors,
        rates=tracking.rate_errors,
    )
    gains = doubles(_VELOCITY_FF.of(name).read_float(params) for name in names)
    pids.group.feed_forward(tracking.velocities, gains)
    return HardwareInterfaceAdapter(tracking, PidLaw(pids.group), pids=pids)


InterfaceT = TypeVar("InterfaceT")


class JointTrajectoryState(NamedTuple):
    """Desired and measured states of one cycle; lists have the shape (n,).

    Attributes:
        stamp: Station time of the cycle [s].
        desired: Desired positions, velocities and accelerations.
        actual: Measured positions and velocities.
        error: Desired minus actual positions and velocities.
    """

    stamp: float
    desired: PosVelAccState
    actual: PosVelAccState
    error: PosVelAccState


_log = logging.getLogger(__name__)

_ALLOW_PARTIAL_JOINTS_GOAL = declare_boolean(
    "allow_partial_joints_goal", "a trajectory may leave joints out", default=False
)
_MAY_END_MOVING = declare_boolean(
    "allow_nonzero_velocity_at_trajectory_end",
    "the last point of a trajectory may have velocities",
    default=True,
)
_CONSTRAINTS = "constraints"
_BASE = declare_string(
    "kinematics/base",
    "link in whose frame the poses of motion primitives are",
    "",
    default_text="the link that carries the first joint",
)
_TIP = declare_string(
    "kinematics/tip",
    "link whose poses those of motion primitives are",
    "",
    default_text="the last link",
)
_STOP_TRAJECTORY_DURATION = declare_number(
    "stop_trajectory_duration",
    "time in which a motion comes to rest; 0: hold at once",
    0.0,
    "s",
    minimum=0.0,
)


_BRAKES = declare_boolean(
    "constraints/decelerate_on_cancel",
    "each joint ends a motion with its own `max_deceleration_on_cancel`, if all have "
    "one, in place of `stop_trajectory_duration`",
    default=False,
)
_DECELERATION = declare_number(
    f"constraints/{EACH_JOINT}/max_deceleration_on_cancel",
    "how `decelerate_on_cancel` brings the joint to rest",
    0.0,
    "rad/s^2",
    minimum=0.0,
)


def _read_decelerations(params: Parameters, joints: Sequence[str]) -> list[float]:
    """Return the deceleration of each joint; empty unless all brake and have one."""
    found = [_DECELERATION.of(name).read_float(params) for name in joints]
    if not _BRAKES.read_bool(params):
        return []
    if all(found):
        return found
    _log.warning(
        "'%s' has no effect: not every joint has a max_deceleration_on_cancel.",
        params.resolve(_BRAKES.name),
    )
    return []


class JointTrajectoryController(Controller[InterfaceT]):
    """Executes trajectories and goals; an adapter commands the hardware.

    Parameters: `joints`; `constraints` with `goal_time`, `stopped_velocity_tolerance`
    and per joint `trajectory` and `goal`; `stop_trajectory_duration` [s], or
    `decelerate_on_cancel` among the constraints, with `max_deceleration_on_cancel`;
    `allow_partial_joints_goal`; `speed_scaling`, 0 to 1, and `speed_scaling_ramp`, the
    time from standstill to full speed [s]; and those of the interface's adapter, see
    `adapter_for`; `kinematics/base` and `kinematics/tip` for motion primitives.
    `robot_description` in this or an outer namespace gives types and
    limits of the joints. `state_publish_rate` and `action_monitor_rate` are accepted
    and have no effect, because the state of every cycle is available.

    The run-time parameter `speed_scaling` slows the executed trajectory down, and 0
    pauses it; the joints stay on the same path.

    Attributes:
        joints: Descriptions of the joints.
        execution: The trajectory that is executed.
        planner: Plans trajectories.
    """

    accepted_parameters: ClassVar[tuple[str, ...]] = (
        "state_publish_rate",
        "action_monitor_rate",
    )
    joints: list[JointDescription]
    execution: TrajectoryExecution
    planner: TrajectoryPlanner
    _adapter: HardwareInterfaceAdapter
    _update: TrajectoryUpdate

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (
            *super().declared_parameters(),
            JOINTS,
            *(each.inside(_CONSTRAINTS) for each in TOLERANCE_PARAMETERS),
            _STOP_TRAJECTORY_DURATION,
            _BRAKES,
            _DECELERATION,
            _ALLOW_PARTIAL_JOINTS_GOAL,
            _MAY_END_MOVING,
            _BASE,
            _TIP,
            *SPEED_PARAMETERS,
            *adapter_parameters(cls.hardware_interface),
        )

    @override
    def init(self, interface: InterfaceT, params: Parameters) -> None:
        self.joint_names = read_joint_names(params)
        description = require_robot_description(params)
        self.joints = [description.joint(name) for name in self.joint_names]
        self._adapter = self.make_adapter(interface, params)
        speed = SpeedScaling.from_parameters(params)
        tolerances = read_tolerances(params.namespace(_CONSTRAINTS), self.joint_names)
        self.execution = TrajectoryExecution(
            self.joints,
            self._adapter.tracking,
            stop_duration=_STOP_TRAJECTORY_DURATION.read_float(params),
            decelerations=_read_decelerations(params, self.joint_names),
            path_bounds=[tolerances[name].path for name in self.joint_names],
            speed=speed,
        )
        self.planner = TrajectoryPlanner(
            self.execution,
            self.joints,
            allow_partial_joints_goal=_ALLOW_PARTIAL_JOINTS_GOAL.read_bool(params),
            may_end_moving=_MAY_END_MOVING.read_bool(params),
        )
        self._update = TrajectoryUpdate(
            self.execution, self._adapter.law, self._adapter.output
        )
        self.sampled = self._update.sampled
        command = self._update.command_joints
        call_directly(self, JointTrajectoryController, update=command)
        base, tip = _BASE.read_str(params), _TIP.read_str(params)

        def chain_in(frame: str) -> JointChain:
            urdf = parse_urdf(description.xml)
            ends = (base, tip) if base and tip else ends_of_chain(urdf, names)
            carrier = frame or base or ends[0]
            return chain_to(urdf, carrier, tip or ends[1], names)

        # The reference of a controller, `controller/joint`, is placed as the joint.
        names = [name.rpartition("/")[2] for name in self.joint_names]
        self.goals = FollowJointTrajectoryPort(
            self.planner,
            MotionSequences(self.joints, chain_in),
            tolerances,
            self.is_running,
            self._state_message,
        )
        self.trajectories = JointTrajectoryPort(self.planner, self.is_running)
        self.tunables = Tunables.joined(self._adapter.tunables, speed.tunables)

    def make_adapter(
        self, interface: InterfaceT, params: Parameters
    ) -> HardwareInterfaceAdapter:
        """Claim the joints and return their adapter; override for new interfaces.

        Args:
            interface: The robot's interface.
            params: The controller's namespace.

        Raises:
            StationError: A joint or a parameter is missing or not allowed.
        """
        return adapter_for(interface, self.joints, params)

    @override
    def starting(self, time: float) -> None:
        self._adapter.tracking.memory.read()
        self.execution.start(time)
        self._adapter.reset()

    @override
    def stopping(self, time: float) -> None:
        """End the active goal for good."""
        self.execution.end_goals(GoalStatus.PREEMPTED, "The controller was stopped.")

    @override
    def aborting(self, time: float) -> None:
        """End the active goal for good."""
        self.execution.end_goals(GoalStatus.ABORTED, "The controller failed.")

    @override
    def update(self, time: float, period: float) -> None:
        self._update.command_joints(time, period)

    @property
    def trajectory_state(self) -> JointTrajectoryState | None:
        """Return the last cycle's desired and measured state; None before the first."""
        sample = self.sample
        if not isinstance(sample, PackedSample):
            return None
        desired, actual, errors, _ = sample.columns
        velocities, accelerations, measured, rate_errors = map(
            sample.column, range(4, 8)
        )
        begun, passed = sample.tail(8)
        return JointTrajectoryState(
            sample.stamp,
            PosVelAccState(desired, velocities, accelerations, begun),
            PosVelAccState(actual, measured, time_from_start=passed),
            PosVelAccState(errors, rate_errors, time_from_start=begun - passed),
        )

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `state` of the original."""
        message = self._state_message()
        return {"state": message} if message else {}

    def _state_message(self) -> dict[str, object]:
        """Return the last state, which is also the feedback of goals. Any thread."""
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


class PositionJointTrajectoryController(
    JointTrajectoryController[PositionJointInterface]
):
    """Commands positions."""


class VelocityJointTrajectoryController(
    JointTrajectoryController[VelocityJointInterface]
):
    """Commands velocities computed from the errors of position and velocity."""


class EffortJointTrajectoryController(JointTrajectoryController[EffortJointInterface]):
    """Commands efforts computed from the errors of position and velocity."""


class PosVelJointTrajectoryController(JointTrajectoryController[PosVelJointInterface]):
    """Commands positions and velocities."""


class PosVelAccJointTrajectoryController(
    JointTrajectoryController[PosVelAccJointInterface]
):
    """Commands positions, velocities and accelerations."""


def _message(state: PosVelAccState) -> dict[str, object]:
    """Return a state in the form of a trajectory_msgs/JointTrajectoryPoint."""
    return {
        "positions": state.position,
        "velocities": state.velocity,
        "accelerations": state.acceleration,
        "time_from_start": state.time_from_start,
    }
