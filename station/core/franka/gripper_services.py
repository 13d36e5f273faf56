"""The grippers of a station by their arms, and the services of franka_gripper.

Programs outside import `GraspRequest` from here, so the module keeps its name.

Source: franka_ros@c11f000 franka_gripper/src/franka_gripper.cpp and
franka_gripper_node.cpp, franka_gripper/action/*.action; libfranka@0.9.2
include/franka/gripper.h, gripper_state.h; differs: a command begins at once and its
progress is in the state; a command that misses its aim is aborted with the reason,
instead of having succeeded with `success` false.
"""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import ClassVar

from typing_extensions import override

from station.core.errors import GripperNotFoundError
from station.core.facade.robots import Robots
from station.core.hardware.interfaces.resource_manager import HardwareResourceManager
from station.core.hardware.services import InterruptibleServices
from station.core.ports.goal import GoalStatus

DEFAULT_SPEED = 0.1
"""Default speed of the width [m/s]. Source: franka_gripper_node.cpp, default_speed."""
DEFAULT_EPSILON = 0.005
"""Tolerance of a grasped object's width [m]. Source: gripper.h, Gripper.grasp."""


class GripperAction(Enum):
    """A command of a hand that takes time."""

    HOMING = "homing"
    MOVE = "move"
    GRASP = "grasp"


class GripperActivity(Enum):
    """The present activity of the fingers."""

    IDLE = "idle"
    """The fingers hold their width without force."""
    HOMING = "homing"
    MOVING = "moving"
    GRASPING = "grasping"
    HOLDING = "holding"
    """The fingers press with the force of the last grasp."""
    CONTROLLED = "controlled"
    """A controller claims the finger joints."""


@dataclass(frozen=True, slots=True)
class GraspRequest:
    """A grasp: close or open until an object blocks the fingers, then press.

    Attributes:
        width: Expected width of the object [m].
        force: Force of each finger on the object [N].
        speed: Speed at which the width changes [m/s].
        epsilon_inner: Largest amount by which the object may be narrower [m].
        epsilon_outer: Largest amount by which the object may be wider [m].
    """

    width: float
    force: float
    speed: float = DEFAULT_SPEED
    epsilon_inner: float = DEFAULT_EPSILON
    epsilon_outer: float = DEFAULT_EPSILON

    def accepts(self, width: float) -> bool:
        """Return whether an object of `width` [m] has the expected width."""
        low, high = self.width - self.epsilon_inner, self.width + self.epsilon_outer
        return low < width < high


@dataclass(frozen=True, slots=True)
class GripperCommand:
    """One homing, move or grasp, and its progress.

    Attributes:
        identifier: Number of the command in this run.
        action: Kind of the command.
        status: `ACTIVE` until the end; then `SUCCEEDED`, `ABORTED` (the command missed
            its aim) or `PREEMPTED` (another request ended it).
        message: Why the command did not succeed; empty after a success.
        request: The requested width, force and so on, by name [m, N, m/s].
        started: Time at which the command began [s, the hand's time].
        ended: Time at which the command ended [s]; None until then.
    """

    identifier: int
    action: GripperAction
    status: GoalStatus
    message: str
    request: dict[str, float] = field(default_factory=dict)
    started: float = 0.0
    ended: float | None = None


@dataclass(frozen=True, slots=True)
class GripperState:
    """The state of a hand.

    Attributes:
        width: Distance between the fingers [m].
        max_width: Largest width, as measured by the last homing [m].
        is_grasped: Whether an object of the expected width is held.
        temperature: Temperature of the hand [degree Celsius].
        time: Time of the hand [s]; never decreases.
        activity: The present activity of the fingers.
        force: Force of each finger, > 0 outwards [N].
        command: The active command; None if there is none.
        last: The last command that ended; None if there is none.
    """

    width: float
    max_width: float
    is_grasped: bool
    temperature: float
    time: float
    activity: GripperActivity
    force: float
    command: GripperCommand | None
    last: GripperCommand | None


class GripperServices(InterruptibleServices):
    """The hand of one arm, under its arm_id. Control thread, between two cycles.

    A command begins at once and ends the command before. No method waits. The hand is
    independent of the errors, the recovery and the connection of the arm.
    """

    @abstractmethod
    def get_state(self) -> GripperState:
        """Return the state of the hand."""

    @abstractmethod
    def homing(self) -> None:
        """Close and open the hand all the way, to measure the largest width.

        Raises:
            GripperCommandError: A controller claims the fingers; nothing changed.
        """

    @abstractmethod
    def move(self, width: float, speed: float = DEFAULT_SPEED) -> None:
        """Open or close to a width.

        Args:
            width: 0 to the largest width [m].
            speed: Speed at which the width changes, above 0 [m/s].

        Raises:
            GripperCommandError: A controller claims the fingers; nothing changed.
            InvalidCommandError: A number is out of range; nothing changed.
        """

    @abstractmethod
    def grasp(self, request: GraspRequest) -> None:
        """Close or open until an object blocks the fingers; then keep pressing it.

        Args:
            request: Width, force and tolerances of the grasp.

        Raises:
            GripperCommandError: A controller claims the fingers; nothing changed.
            InvalidCommandError: A number is out of range; nothing changed.
        """

    @abstractmethod
    def stop(self) -> None:
        """Stop the fingers and end their force; possible at any time.

        If a controller claims the fingers, they continue to obey that controller.
        """

    @override
    @abstractmethod
    def interrupt(self, reason: str) -> None:
        """End a motion; a grasped object stays grasped.

        Args:
            reason: Why the command ends, in one sentence.
        """


class GripperServicesInterface(HardwareResourceManager[GripperServices]):
    """Hands by arm_id."""

    type_name: ClassVar[str] = "franka_gripper::GripperServicesInterface"


class Grippers:
    """The grippers of one station's arms.

    No method waits for the fingers: a command begins between two cycles, and the state
    shows its progress.

    Every method raises `ArmNotFoundError` if there is no such arm,
    `GripperNotFoundError` if the arm has no gripper, and `LoopError` if the loop died
    or hangs. Every command but `stop` raises `StoppedError` while the station is
    stopped, and the errors of the same method of `GripperServices`.

    Args:
        robots: The robots of the station.
    """

    def __init__(self, robots: Robots) -> None:
        self._robots = robots

    def state(self, arm_id: str) -> GripperState:
        """Return the state of a gripper."""
        return self._robots.run(self._find(arm_id).get_state)

    def homing(self, arm_id: str) -> GripperState:
        """Begin to close and then open a gripper all the way."""
        return self._begin(arm_id, lambda gripper: gripper.homing())

    def move(
        self, arm_id: str, width: float, speed: float = DEFAULT_SPEED
    ) -> GripperState:
        """Begin to open or close a gripper to a width [m], at a speed [m/s]."""
        return self._begin(arm_id, lambda gripper: gripper.move(width, speed))

    def grasp(self, arm_id: str, request: GraspRequest) -> GripperState:
        """Begin to grasp an object."""
        return self._begin(arm_id, lambda gripper: gripper.grasp(request))

    def stop(self, arm_id: str) -> GripperState:
        """Hold the fingers still without force; works while the station is stopped."""
        return self._begin(arm_id, lambda gripper: gripper.stop(), moves=False)

    def _begin(
        self,
        arm_id: str,
        command: Callable[[GripperServices], None],
        *,
        moves: bool = True,
    ) -> GripperState:
        gripper = self._find(arm_id)

        def begin() -> GripperState:
            command(gripper)
            return gripper.get_state()

        return self._robots.run(begin, moves=moves)

    def _find(self, arm_id: str) -> GripperServices:
        kind: type[GripperServices] = GripperServices  # type: ignore[type-abstract]
        gripper = self._robots.get(arm_id, kind)
        if gripper is None:
            having = ", ".join(self._robots.names(GripperServices)) or "none"
            raise GripperNotFoundError(
                f"Arm '{arm_id}' has no gripper.",
                remedy=f"These arms have a gripper: {having}.",
                details={"arm_id": arm_id},
            )
        return gripper
