"""Services of franka_gripper: homing, move, grasp, stop and the state of a gripper.

Source: franka_ros@c11f000 franka_gripper/src/franka_gripper.cpp and
franka_gripper_node.cpp, franka_gripper/action/*.action; libfranka@0.9.2
include/franka/gripper.h, gripper_state.h; differs: a command begins at once and is
asked about, and one that did not reach its aim is aborted with the reason, instead of
having succeeded with `success` false.
"""

from abc import abstractmethod
from dataclasses import dataclass, field
from enum import Enum
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.interfaces.resource_manager import HardwareResourceManager
from station.core.hardware.services import InterruptibleServices
from station.core.ports.goal import GoalStatus

DEFAULT_SPEED = 0.1
"""How fast the width changes [m/s]. Source: franka_gripper_node.cpp, default_speed."""
DEFAULT_EPSILON = 0.005
"""Tolerance of a grasped object's width [m]. Source: gripper.h, Gripper.grasp."""


class GripperAction(Enum):
    """What a hand can be told to do for a while."""

    HOMING = "homing"
    MOVE = "move"
    GRASP = "grasp"


class GripperActivity(Enum):
    """What the fingers are doing."""

    IDLE = "idle"
    """They stay where they are; nothing is held with force."""
    HOMING = "homing"
    MOVING = "moving"
    GRASPING = "grasping"
    HOLDING = "holding"
    """They press with the force of the last grasp."""
    CONTROLLED = "controlled"
    """A controller claims the finger joints."""


@dataclass(frozen=True, slots=True)
class GraspRequest:
    """A grasp: close (or open) until something is in the way, then press.

    Attributes:
        width: Expected width of the object [m].
        force: What each finger presses the object with [N].
        speed: How fast the width changes [m/s].
        epsilon_inner: How much narrower the object may be [m].
        epsilon_outer: How much wider the object may be [m].
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
    """One homing, move or grasp, and how far it is.

    Attributes:
        identifier: Its number in this run.
        action: What was asked for.
        status: `ACTIVE`, and then for good `SUCCEEDED`, `ABORTED` (it did not reach
            its aim) or `PREEMPTED` (something else ended it).
        message: Why it did not succeed; else empty.
        request: What was asked for: width, force and so on, by name [m, N, m/s].
        started: When it began [s, the hand's time].
        ended: When it ended; None until then.
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
    """A hand at a glance.

    Attributes:
        width: Distance between the fingers [m].
        max_width: Largest one, as the last homing has measured it [m].
        is_grasped: Something of the expected width is held.
        temperature: Of the hand [degree Celsius].
        time: Of the hand [s]; never goes back.
        activity: What the fingers are doing.
        force: What each finger presses with, > 0 outwards [N].
        command: What it was told and has not finished.
        last: The last command that ended.
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

    A command begins at once and ends the command before. No command waits, and no
    command depends on the arm: a gripper works while its arm has errors, recovers or
    is disconnected.
    """

    @abstractmethod
    def get_state(self) -> GripperState:
        """Return the state of the hand."""

    @abstractmethod
    def homing(self) -> None:
        """Close and open the hand all the way; that measures the largest width.

        Raises:
            GripperCommandError: A controller claims the fingers; nothing changed.
        """

    @abstractmethod
    def move(self, width: float, speed: float = DEFAULT_SPEED) -> None:
        """Open or close to a width.

        Args:
            width: 0 to the largest one [m].
            speed: How fast the width changes, above 0 [m/s].

        Raises:
            GripperCommandError: A controller claims the fingers; nothing changed.
            InvalidCommandError: A number is out of range; nothing changed.
        """

    @abstractmethod
    def grasp(self, request: GraspRequest) -> None:
        """Close, or open, until something is in the way, and press it from then on.

        Args:
            request: What to grasp.

        Raises:
            GripperCommandError: A controller claims the fingers; nothing changed.
            InvalidCommandError: A number is out of range; nothing changed.
        """

    @abstractmethod
    def stop(self) -> None:
        """Stand still and press no more; possible at any time.

        Fingers that a controller claims go on obeying it.
        """

    @override
    @abstractmethod
    def interrupt(self, reason: str) -> None:
        """End a motion; a grasped object stays grasped.

        Args:
            reason: Why, one sentence.
        """


class GripperServicesInterface(HardwareResourceManager[GripperServices]):
    """Hands by arm_id."""

    type_name: ClassVar[str] = "franka_gripper::GripperServicesInterface"
