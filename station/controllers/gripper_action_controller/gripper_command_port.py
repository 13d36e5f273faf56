"""The goal of the action gripper_cmd, and where a gripper takes it.

Source: control_msgs@1.5.2 action/GripperCommand.action, msg/GripperCommand.msg.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite

from typing_extensions import override

from station.core.description.robot_description import JointDescription
from station.core.errors import ControllerStateError, InvalidCommandError
from station.core.ports.goal import Goal, GoalPort


@dataclass(frozen=True, slots=True)
class GripperCommand:
    """What a gripper is asked for.

    Attributes:
        position: Where the joint shall go [m or rad].
        max_effort: Largest effort on the way [N or Nm], >= 0.
    """

    position: float
    max_effort: float


class GripperCommandPort(GoalPort):
    """Checks goals; the controller takes them up.

    Args:
        joint: The gripper's joint.
        max_effort: Effort of goals that name none [N or Nm], >= 0.
        is_running: Says whether the controller is running.
        feedback: Gives the feedback message of the active goal.

    Attributes:
        waiting: Goals that were not taken up yet, oldest first.
    """

    def __init__(
        self,
        joint: JointDescription,
        max_effort: float,
        is_running: Callable[[], bool],
        feedback: Callable[[], Mapping[str, object]],
    ) -> None:
        super().__init__()
        self.waiting: deque[tuple[Goal, GripperCommand]] = deque()
        self._joint = joint
        self._max_effort = max_effort
        self._is_running = is_running
        self._feedback = feedback

    @override
    def submit(self, request: Mapping[str, object]) -> Goal:
        """Check a goal and let it replace the present one.

        Args:
            request: `{"command": {"position", "max_effort"}}`; `max_effort` may be
                left out, its sign does not count.

        Raises:
            ControllerStateError: The controller is not running.
            InvalidCommandError: The goal is malformed or out of the joint's range.
        """
        command = self._parse(request)
        if not self._is_running():
            raise ControllerStateError(
                "The controller is not running; it takes goals only then.",
                remedy="Start it with POST /controllers/switch.",
            )
        goal = self.new_goal(request)
        goal.feedback = self._feedback
        self.remember(goal)
        self.waiting.append((goal, command))
        return goal

    def _parse(self, request: Mapping[str, object]) -> GripperCommand:
        message = request.get("command")
        if not isinstance(message, Mapping) or set(request) != {"command"}:
            raise _malformed(f"The goal is {dict(request)!r}.")
        unknown = set(message) - {"position", "max_effort"}
        if unknown:
            raise _malformed(f"The command has the unknown fields {sorted(unknown)}.")
        joint = self._joint
        position = _number(message, "position", None)
        if not joint.lower <= position <= joint.upper:
            raise InvalidCommandError(
                f"The position for '{joint.name}' is {position}; allowed is "
                f"{joint.lower} to {joint.upper}.",
                remedy="Give a position within the limits of the joint.",
                details={"joint": joint.name, "reason": "limits"},
            )
        effort = _number(message, "max_effort", self._max_effort)
        return GripperCommand(position, abs(effort))


def _number(message: Mapping[str, object], key: str, default: float | None) -> float:
    value = message.get(key, default)
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not isfinite(float(str(value))):
        raise _malformed(f"'command/{key}' is {value!r}; it must be a finite number.")
    return float(str(value))


def _malformed(message: str) -> InvalidCommandError:
    return InvalidCommandError(
        message,
        remedy='Send {"command": {"position": 0.02, "max_effort": 10.0}}.',
        details={"reason": "malformed"},
    )
