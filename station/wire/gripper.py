"""Wire models of a gripper: its state and its commands."""

from typing import Annotated, Literal

from pydantic import AliasChoices, Field

from station.wire.base import FromEnum, Measured, Reason, RequestModel, ResponseModel

GripperActionName = Annotated[Literal["homing", "move", "grasp"], FromEnum]
GripperActivityName = Annotated[
    Literal["idle", "homing", "moving", "grasping", "holding", "controlled"], FromEnum
]
GripperCommandStatus = Annotated[
    Literal["active", "succeeded", "aborted", "preempted"], FromEnum
]

_Identifier = Annotated[str, Field(strict=False, coerce_numbers_to_str=True)]
_Distance = Annotated[float, Field(ge=0.0)]
_Positive = Annotated[float, Field(gt=0.0)]


class GripperCommand(ResponseModel):
    """One homing, move or grasp, and how far it is.

    Attributes:
        id: Its number in this run of the station.
        action: What was asked for.
        status: `active`, and finally `succeeded`, `aborted` (it did not reach its aim)
            or `preempted` (another command or a stop ended it).
        message: Why it did not succeed; empty when it did.
        request: The numbers that were asked for, by name [m, m/s, N].
        started: When it began [s, `time` of the gripper].
        ended: When it ended; null until then.
    """

    id: _Identifier = Field(validation_alias=AliasChoices("id", "identifier"))
    action: GripperActionName
    status: GripperCommandStatus
    message: Reason
    request: dict[str, float]
    started: float
    ended: float | None


class Gripper(ResponseModel):
    """A gripper's state, as `franka_gripper` has it, and its activity.

    Attributes:
        arm_id: The arm it belongs to.
        width: Distance between the fingers [m].
        max_width: Largest one, as the last homing has measured it [m].
        is_grasped: Something of the expected width is held.
        temperature: Of the gripper [degree Celsius].
        time: Of the gripper [s]; never goes back.
        activity: What the fingers are doing. `holding`: they press with the force of
            the last grasp. `controlled`: a controller claims their joints.
        force: What each finger presses with, > 0 outwards [N].
        command: The command that is active; null when there is none.
        last: The last command that ended; null when there is none.
    """

    arm_id: str
    width: Measured
    max_width: float
    is_grasped: bool
    temperature: float
    time: float
    activity: GripperActivityName
    force: Measured
    command: GripperCommand | None
    last: GripperCommand | None


class GripperMoveRequest(RequestModel):
    """Open or close to a width.

    Attributes:
        width: 0 to the largest one [m].
        speed: How fast the width changes, at most 0.4 [m/s].

    Example:
        {"width": 0.04, "speed": 0.1}
    """

    width: _Distance
    speed: _Positive = 0.1


class GraspEpsilon(RequestModel):
    """Tolerance of the width of a grasped object.

    Attributes:
        inner: How much narrower [m].
        outer: How much wider [m].
    """

    inner: _Distance = 0.005
    outer: _Distance = 0.005


class GripperGraspRequest(RequestModel):
    """Close, or open from within, until something is in the way, and press it.

    Attributes:
        width: Expected width of the object, less than the largest one [m].
        force: What each finger presses it with, 0.1 to 140 [N].
        speed: How fast the width changes, at most 0.4 [m/s].
        epsilon: Tolerance of the width.

    Example:
        {"width": 0.03, "force": 20.0}
    """

    width: _Distance
    force: _Positive
    speed: _Positive = 0.1
    epsilon: GraspEpsilon = GraspEpsilon()
