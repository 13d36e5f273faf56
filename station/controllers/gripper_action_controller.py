"""Open and close a gripper with one joint by goals.

Source: ros_controllers@678b92a gripper_action_controller/
gripper_action_controller.h, gripper_action_controller_impl.h,
hardware_interface_adapter.h; control_msgs@1.5.2 action/GripperCommand.action,
msg/GripperCommand.msg.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.controllers.set_point_controller import (
    JOINT,
    JointPidGroup,
    JointQuantity,
    pid_parameters,
)
from station.core.control.controller import Controller, ControllerSample
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_boolean,
    declare_number,
    declare_string,
)
from station.core.description.robot_description import (
    JointDescription,
    require_robot_description,
)
from station.core.errors import InvalidCommandError, ParameterError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    JointHandle,
    PositionJointInterface,
)
from station.core.numerics.pid import PidGains
from station.core.parameters import Parameters
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import Goal, GoalPort, GoalResult, GoalStatus
from station.core.ports.set_point import RANGE_TOLERANCE


@dataclass(frozen=True, slots=True)
class GripperTarget:
    """The position and the effort requested of a gripper.

    Attributes:
        position: Desired position of the joint [m or rad].
        max_effort: Largest effort [N or Nm], >= 0.
        max_velocity: Largest velocity of the command [m/s or rad/s], > 0.
    """

    position: float
    max_effort: float
    max_velocity: float = inf


class GripperGoalPort(GoalPort):
    """Checks goals and queues them for the controller.

    Args:
        joint: The gripper's joint.
        max_effort: Effort of goals that do not state one [N or Nm], >= 0.
        is_running: Returns whether the controller is running.
        feedback: Returns the feedback message of the active goal.

    Attributes:
        waiting: Goals that the controller has yet to take up, oldest first.
    """

    def __init__(
        self,
        joint: JointDescription,
        max_effort: float,
        is_running: Callable[[], bool],
        feedback: Callable[[], Mapping[str, object]],
    ) -> None:
        super().__init__(is_running, feedback)
        self.waiting: deque[tuple[Goal, GripperTarget]] = deque()
        self._joint = joint
        self._max_effort = max_effort

    @override
    def submit(
        self, request: Mapping[str, object], ticket: CommandTicket | None = None
    ) -> Goal:
        """Check a goal and let it replace the present one.

        Args:
            request: `{"command": {"position", "max_effort"}}`; `max_effort` is
                optional, and its sign is ignored.
            ticket: Notes the cycle that takes the goal.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidCommandError: The goal is malformed, or its position is beyond the
                limits of the joint.
        """
        command = self._parse(request)
        goal = self.new_goal(request, ticket)
        self.remember(goal)
        if ticket is None:
            self.waiting.append((goal, command))
        else:
            ticket.hand_over(lambda: self.waiting.append((goal, command)))
        return goal

    def _parse(self, request: Mapping[str, object]) -> GripperTarget:
        message = request.get("command")
        if not isinstance(message, Mapping) or set(request) != {"command"}:
            raise _malformed(f"The goal is {dict(request)!r}.")
        unknown = set(message) - {"position", "max_effort"}
        if unknown:
            raise _malformed(f"The command has the unknown fields {sorted(unknown)}.")
        effort = _number(message, "max_effort", self._max_effort)
        return self.target(_number(message, "position", None), effort)

    def target(self, position: float, effort: float) -> GripperTarget:
        """Return the target of a goal.

        Args:
            position: Position of the goal [m or rad].
            effort: Its effort [N or Nm]; the sign does not matter.

        Raises:
            InvalidCommandError: The position is beyond the limits of the joint.
        """
        joint = self._joint
        inside = min(max(position, joint.lower), joint.upper)
        if abs(position - inside) > RANGE_TOLERANCE:
            raise InvalidCommandError(
                f"The position for '{joint.name}' is {position}; allowed is "
                f"{joint.lower} to {joint.upper}.",
                remedy="Give a position within the limits of the joint.",
                details={"joint": joint.name, "reason": "limits"},
            )
        return GripperTarget(inside, abs(effort))


class ParallelGripperGoalPort(GripperGoalPort):
    """Takes goals of the action ParallelGripperCommand, whose command is a JointState.

    Attributes:
        max_velocity: Velocity of goals that do not state one [m/s or rad/s], > 0.

    Source:
        control_msgs@5.x action/ParallelGripperCommand.action.
    """

    max_velocity = inf

    @override
    def _parse(self, request: Mapping[str, object]) -> GripperTarget:
        message = request.get("command")
        if not isinstance(message, Mapping) or set(request) != {"command"}:
            raise _malformed(f"The goal is {dict(request)!r}.", _PARALLEL)
        numbers = {}
        defaults = {"velocity": self.max_velocity, "effort": self._max_effort}
        for key, value in message.items():
            is_name = key == "name" and value in ([], [self._joint.name])
            if not is_name and key not in {"position", *defaults}:
                raise _malformed(f"'command/{key}' is {value!r}.", _PARALLEL)
            if not is_name and (not isinstance(value, list) or len(value) > 1):
                raise _malformed(
                    f"'command/{key}' is {value!r}; it must be one number in a list.",
                    _PARALLEL,
                )
            if not is_name and value:
                numbers[key] = value[0]
        position = _number(numbers, "position", None, _PARALLEL)
        velocity, effort = (
            _number(numbers, key, default, _PARALLEL)
            for key, default in defaults.items()
        )
        if not velocity > 0.0:
            raise _malformed(f"'command/velocity' is {velocity}.", _PARALLEL)
        return replace(self.target(position, effort), max_velocity=velocity)


_SINGLE = '{"command": {"position": 0.02, "max_effort": 10.0}}'
_PARALLEL = '{"command": {"position": [0.02], "velocity": [0.1], "effort": [10.0]}}'


def _number(
    message: Mapping[str, object],
    key: str,
    default: float | None,
    example: str = _SINGLE,
) -> float:
    value = message.get(key, default)
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or (key in message and not isfinite(float(str(value)))):
        raise _malformed(
            f"'command/{key}' is {value!r}; it must be a finite number.", example
        )
    return float(str(value))


def _malformed(message: str, example: str = _SINGLE) -> InvalidCommandError:
    return InvalidCommandError(
        message,
        remedy=f"Send {example}.",
        details={"reason": "malformed"},
    )


CommandInterfaceT = TypeVar("CommandInterfaceT", bound=JointCommandInterface)


_GOAL_TOLERANCE = declare_number(
    "goal_tolerance",
    "largest distance to the goal that counts as reached",
    0.01,
    "m or rad",
)
_MAX_EFFORT = declare_number(
    "max_effort",
    "largest effort of goals that do not state one",
    unit="N or Nm",
    default_text="effort limit",
)
_STALL_VELOCITY = declare_number(
    "stall_velocity_threshold",
    "velocity below which the joint stands still",
    0.001,
    "m/s or rad/s",
)
_STALL_TIMEOUT = declare_number(
    "stall_timeout",
    "a goal is aborted when the joint stands still elsewhere for this time",
    1.0,
    "s",
)
_LARGEST_YIELD = 0.5
"""Least factor by which a cycle may reduce the distance of a command from the joint."""
_ENOUGH = 0.9
"""Share of the goal's effort from which on the command keeps its distance."""
_LEAST_REACH = 1e-6
"""Least distance of a command from a joint that presses too strongly [m or rad]."""
_REACH_GROWTH = 10.0
"""Rate at which that distance grows while the effort is small enough [1/s]."""


class GripperActionController(Controller[CommandInterfaceT]):
    """Moves the joint to the position of a goal; subclasses command the hardware.

    A goal succeeds when the joint is within `goal_tolerance` of the goal's position. A
    goal is aborted, with `stalled` in its details, when the joint stands still
    elsewhere for `stall_timeout`: an object is between the fingers, and the fingers
    keep pressing.

    Parameters: `joint`; `goal_tolerance` [m or rad], 0.01; `max_effort` [N or Nm], for
    goals without one; `stall_velocity_threshold` [m/s or rad/s], 0.001;
    `stall_timeout` [s], 1.0. `action_monitor_rate` is accepted and has no effect.

    Attributes:
        joint: Description of the joint.
        port_type: Class of the port that checks the goals.

    Source:
        GripperActionController; differs: `max_effort` is the joint's effort limit by
        default, because with the original's 0 the fingers do not move; a position
        beyond the joint's limits is refused.
    """

    accepted_parameters: ClassVar[tuple[str, ...]] = ("action_monitor_rate",)
    port_type: ClassVar[type[GripperGoalPort]] = GripperGoalPort
    joint: JointDescription
    _allows_stalling = False
    _handle: JointHandle
    _port: GripperGoalPort
    own_parameters: ClassVar[tuple[DeclaredParameter, ...]] = (
        JOINT,
        _GOAL_TOLERANCE,
        _MAX_EFFORT,
        _STALL_VELOCITY,
        _STALL_TIMEOUT,
    )

    def __init__(self) -> None:
        super().__init__()
        self._target = GripperTarget(0.0, 0.0)
        self._goal: Goal | None = None
        self._distance = 0.0
        self._last_movement = 0.0

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        name = JOINT.read_str(params)
        self.joint_names = [name]
        self.joint = require_robot_description(params).joint(name)
        self._handle = interface.get_handle(name)
        self._tolerance = abs(_GOAL_TOLERANCE.read_float(params))
        self._max_effort = self._read_max_effort(params)
        self._stall_velocity = _STALL_VELOCITY.read_float(params)
        self._stall_timeout = _STALL_TIMEOUT.read_float(params)
        self._port = self.port_type(
            self.joint, self._max_effort, self.is_running, self._feedback
        )
        self.goals = self._port

    def command_joint(
        self, handle: JointHandle, target: GripperTarget, period: float
    ) -> float:
        """Command the joint towards `target`; return the command.

        Args:
            handle: The joint.
            target: Desired position and largest effort.
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError

    @override
    def starting(self, time: float) -> None:
        self._end_goals(GoalStatus.PREEMPTED, "The controller was restarted.")
        self._hold()
        self._last_movement = time

    @override
    def stopping(self, time: float) -> None:
        """End the active goal for good."""
        self._end_goals(GoalStatus.PREEMPTED, "The controller was stopped.")

    @override
    def aborting(self, time: float) -> None:
        """End the active goal for good."""
        self._end_goals(GoalStatus.ABORTED, "The controller failed.")

    @override
    def update(self, time: float, period: float) -> None:
        handle = self._handle
        while self._port.waiting:
            self._take_up(*self._port.waiting[0], time)
            self._port.waiting.popleft()
        goal = self._goal
        if goal is not None and goal.cancel_requested:
            goal.finish(GoalStatus.PREEMPTED, GoalResult(0, goal.cancel_reason))
            self._goal = None
            self._hold()
        position = handle.get_position()
        error = self._target.position - position
        output = self.command_joint(handle, self._target, period)
        if self._goal is not None:
            self._supervise(self._goal, handle, error, time)
        self.sample = ControllerSample(
            time, [self._target.position], [position], [error], [output]
        )

    def _take_up(self, goal: Goal, target: GripperTarget, time: float) -> None:
        if self._goal is not None:
            replaced = GoalResult(0, "Another goal replaced this goal.")
            self._goal.finish(GoalStatus.PREEMPTED, replaced)
        if not goal.is_final():
            goal.status = GoalStatus.ACTIVE
        if goal.ticket is not None:
            goal.ticket.accept()
        self._goal = goal
        self._target = target
        self._last_movement = time
        self._distance = abs(target.position - self._handle.get_position())

    def _supervise(
        self, goal: Goal, handle: JointHandle, error: float, time: float
    ) -> None:
        if self._distance > 0.0:
            covered = 1.0 - abs(error) / self._distance
            goal.progress = min(1.0, max(goal.progress, covered))
        if abs(error) < self._tolerance:
            goal.progress = 1.0
            goal.finish(GoalStatus.SUCCEEDED, self._result(handle, error))
            self._goal = None
        elif abs(handle.get_velocity()) > self._stall_velocity:
            self._last_movement = time
        elif time - self._last_movement > self._stall_timeout:
            succeeds = self._allows_stalling
            status = GoalStatus.SUCCEEDED if succeeds else GoalStatus.ABORTED
            goal.finish(status, self._result(handle, error))
            self._goal = None

    def _result(self, handle: JointHandle, error: float) -> GoalResult:
        """Return the result of the action."""
        stalled = abs(error) >= self._tolerance
        unit = "m" if self.joint.is_linear() else "rad"
        position = handle.get_position()
        message = (
            f"Joint '{self.joint.name}' stands still at {position:.6g} {unit}, "
            f"{abs(error):.6g} {unit} from its goal; allowed are "
            f"{self._tolerance:.6g} {unit}."
        )
        details = self._details(handle, stalled=stalled, reached=not stalled)
        if stalled:
            details |= {
                "joint": self.joint.name,
                "error": error,
                "tolerance": self._tolerance,
            }
        return GoalResult(0, message if stalled else "", details)

    def _feedback(self) -> dict[str, object]:
        """Return the feedback of the active goal. Any thread."""
        return self._details(self._handle, stalled=False, reached=False)

    def _details(
        self, handle: JointHandle, *, stalled: bool, reached: bool
    ) -> dict[str, object]:
        return {
            "position": handle.get_position(),
            "effort": handle.get_effort(),
            "stalled": stalled,
            "reached_goal": reached,
        }

    def _hold(self) -> None:
        """Make the present position of the joint the target."""
        position = self._handle.get_position()
        self._target = GripperTarget(position, self._max_effort)

    def _end_goals(self, status: GoalStatus, reason: str) -> None:
        if self._goal is not None:
            self._goal.finish(status, GoalResult(0, reason))
            self._goal = None
        while self._port.waiting:
            self._port.waiting.popleft()[0].finish(status, GoalResult(0, reason))

    def _read_max_effort(self, params: Parameters) -> float:
        """Return the largest effort of goals that do not state one [N or Nm].

        Raises:
            ParameterError: Neither the parameter nor the joint has a finite effort.
        """
        limit = self.joint.effort
        effort = abs(_MAX_EFFORT.read_float(params, limit if limit < inf else -inf))
        if not isfinite(effort):
            raise ParameterError(
                f"Parameter '{params.resolve(_MAX_EFFORT.name)}' is missing, and joint "
                f"'{self.joint.name}' has no effort limit.",
                remedy="Give the largest effort of the gripper in N or Nm.",
                details={"parameter": params.resolve(_MAX_EFFORT.name)},
            )
        return effort


class PositionGripperActionController(GripperActionController[PositionJointInterface]):
    """Commands the position of the goal, or one nearer to the joint.

    The effort that presses on an object grows with the distance of the command from the
    joint. While the measured effort is larger than that of the goal, the command comes
    closer to the joint.

    Source:
        HardwareInterfaceAdapter of the position interface; differs: the original
        ignores `max_effort`. On a robot that measures no effort, `max_effort` has no
        effect.
    """

    def __init__(self) -> None:
        super().__init__()
        self._reach = inf
        self._reach_of: GripperTarget | None = None

    @override
    def command_joint(
        self, handle: JointHandle, target: GripperTarget, period: float
    ) -> float:
        if target is not self._reach_of:
            self._reach, self._reach_of = inf, target
        position, effort = handle.get_position(), handle.get_effort()
        wanted = self.next_position(target, period)
        way = wanted - position
        pressing = abs(effort) if effort * way > 0.0 else 0.0
        if pressing > target.max_effort:
            share = max(target.max_effort / pressing, _LARGEST_YIELD)
            self._reach = max(min(self._reach, abs(way)) * share, _LEAST_REACH)
        elif self._reach < inf and pressing < _ENOUGH * target.max_effort:
            # It grows slowly: the effort may follow the command with a delay.
            self._reach *= 1.0 + _REACH_GROWTH * period
        if abs(way) <= self._reach:
            command = wanted
        else:
            command = position + (self._reach if way > 0.0 else -self._reach)
        handle.set_command(command)
        return command

    def next_position(self, target: GripperTarget, period: float) -> float:  # noqa: ARG002 - a subclass's
        """Return the next position on the way to the target.

        Args:
            target: The target.
            period: Time since the last cycle [s], >= 0.
        """
        return target.position


_PARALLEL_EFFORT = replace(_MAX_EFFORT, default_text="", default=10.0, minimum=0.0)
_MAX_VELOCITY = declare_number(
    "max_velocity",
    "velocity of goals that do not state one",
    0.1,
    "m/s or rad/s",
    minimum=0.0,
    excludes_minimum=True,
)
_EFFORT_INTERFACE, _VELOCITY_INTERFACE = (
    declare_string(f"max_{kind}_interface", f"if it is given, max_{kind} counts", "")
    for kind in ("effort", "velocity")
)
_ALLOW_STALLING = declare_boolean(
    "allow_stalling",
    "whether a goal succeeds when the joint stands still elsewhere",
    default=False,
)


class ParallelGripperActionController(PositionGripperActionController):
    """Moves a gripper to the position of a goal, with the goal's velocity and effort.

    Source:
        ros2_controllers@6.x parallel_gripper_controller; differs: velocity and effort
        are kept here and need no interfaces of the hardware. Those of a goal count
        always, those of the parameters with `max_velocity_interface` and
        `max_effort_interface`; without them the original has none either. A position
        beyond the joint's limits is refused.
    """

    accepted_parameters: ClassVar[tuple[str, ...]] = (
        "action_monitor_rate",
        "state_interfaces",
    )
    port_type: ClassVar[type[GripperGoalPort]] = ParallelGripperGoalPort

    def __init__(self) -> None:
        super().__init__()
        self._way_of: GripperTarget | None = None
        self._on_the_way = 0.0

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        inherited = super().declared_parameters()
        return (
            *(each for each in inherited if each.name != _MAX_EFFORT.name),
            _PARALLEL_EFFORT,
            _EFFORT_INTERFACE,
            _MAX_VELOCITY,
            _VELOCITY_INTERFACE,
            _ALLOW_STALLING,
        )

    @override
    def init(self, interface: PositionJointInterface, params: Parameters) -> None:
        super().init(interface, params)
        self._allows_stalling = _ALLOW_STALLING.read_bool(params)
        velocity = _MAX_VELOCITY.read_float(params)
        has_interface = bool(_VELOCITY_INTERFACE.read_str(params))
        if has_interface and isinstance(self._port, ParallelGripperGoalPort):
            self._port.max_velocity = velocity

    @override
    def next_position(self, target: GripperTarget, period: float) -> float:
        if target is not self._way_of:
            self._way_of, self._on_the_way = target, self._handle.get_position()
        step = target.max_velocity * period
        left = target.position - self._on_the_way
        # A velocity without a bound makes an infinite step, or none in a pause.
        self._on_the_way += max(-step, min(step, left)) if period > 0.0 else 0.0
        return self._on_the_way

    @override
    def _read_max_effort(self, params: Parameters) -> float:
        effort = _PARALLEL_EFFORT.read_float(params)
        return effort if _EFFORT_INTERFACE.read_str(params) else inf

    @override
    def _details(
        self, handle: JointHandle, *, stalled: bool, reached: bool
    ) -> dict[str, object]:
        state = {
            "name": [self.joint.name],
            "position": [handle.get_position()],
            "velocity": [handle.get_velocity()],
            "effort": [handle.get_effort()],
        }
        return {"state": state, "stalled": stalled, "reached_goal": reached}


class EffortGripperActionController(GripperActionController[EffortJointInterface]):
    """Commands the output of a PID, bounded by the effort of the goal.

    Parameters: those of the base class, and the gains of the joint, see
    `PidGains.of_joints`.
    """

    _pids: JointPidGroup
    own_parameters = (
        *pid_parameters(error=JointQuantity.POSITION, command=JointQuantity.EFFORT),
    )

    @override
    def init(self, interface: EffortJointInterface, params: Parameters) -> None:
        super().init(interface, params)
        self._pids = JointPidGroup(
            [self.joint],
            PidGains.of_joints(params, [self.joint.name]),
            places=PidGains.places(params, [self.joint.name]),
            error=JointQuantity.POSITION,
            command=JointQuantity.EFFORT,
        )
        self.tunables = self._pids.tunables

    @override
    def starting(self, time: float) -> None:
        super().starting(time)
        self._pids.reset()

    @override
    def command_joint(
        self, handle: JointHandle, target: GripperTarget, period: float
    ) -> float:
        pids = self._pids
        pids.errors[0] = target.position - handle.get_position()
        pids.rates[0] = -handle.get_velocity()
        pids.group.compute_commands(period, rates_known=True)
        wanted = pids.commands[0]
        effort = max(-target.max_effort, min(target.max_effort, wanted))
        handle.set_command(effort)
        return effort
