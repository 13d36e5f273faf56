"""Goals of the action gripper_cmd: the message, its checks, and the queue.

Source: control_msgs@1.5.2 action/GripperCommand.action, msg/GripperCommand.msg.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf, isfinite

from typing_extensions import override

from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidCommandError
from station.core.ports.goal import Goal, GoalPort
from station.core.ports.receipt import Receipt
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
        self, request: Mapping[str, object], receipt: Receipt | None = None
    ) -> Goal:
        """Check a goal and let it replace the present one.

        Args:
            request: `{"command": {"position", "max_effort"}}`; `max_effort` is
                optional, and its sign is ignored.
            receipt: Where the cycle is noted that takes the goal up.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidCommandError: The goal is malformed, or its position is beyond the
                limits of the joint.
        """
        command = self._parse(request)
        goal = self.new_goal(request, receipt)
        self.remember(goal)
        if receipt is None:
            self.waiting.append((goal, command))
        else:
            receipt.hand_over(lambda: self.waiting.append((goal, command)))
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
