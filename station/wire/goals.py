"""Wire models of goals and trajectories."""

from typing import Annotated, Literal

from pydantic import Field, JsonValue

from station.wire.base import (
    FromEnum,
    Items,
    Measurements,
    ParameterValues,
    Reason,
    RequestModel,
    ResponseModel,
)

GoalStatusName = Annotated[
    Literal["pending", "active", "preempted", "succeeded", "aborted"], FromEnum
]


class GoalRequest(RequestModel):
    """Give a controller a goal; it replaces the one before.

    Attributes:
        goal: The goal message of the controller's action: control_msgs/
            FollowJointTrajectoryGoal with times in seconds, or GripperCommandGoal.
        epoch: Epoch it was made for; refused when a stop or reset came since.

    Example:
        {"goal": {"trajectory": {"joint_names": ["panda_joint1", "panda_joint2"],
         "points": [{"positions": [0.3, -0.5], "time_from_start": 2.0}]},
         "goal_time_tolerance": 0.5}}
        {"goal": {"command": {"position": 0.02, "max_effort": 10.0}}}
    """

    goal: ParameterValues
    epoch: int | None = Field(default=None, ge=0)


class GoalResult(ResponseModel):
    """Result of a goal.

    Attributes:
        code: The action's number for it; 0 for success and an end from outside.
        message: Why, one sentence; empty on success.
        details: The facts of the message: joint, quantity, error, tolerance, time …
    """

    code: int
    message: Reason
    details: dict[str, JsonValue]


class Goal(ResponseModel):
    """A goal and how far it is.

    Attributes:
        id: Its name within the controller.
        status: Its status; the last three are final.
        progress: Part of its time that has passed, 0 to 1.
        cancel_requested: The goal is to be cancelled.
        feedback: The action's feedback while the goal is active: desired and actual
            states and errors of joints, or position and effort of a gripper.
        result: How it ended; null until then.
    """

    id: str
    status: GoalStatusName
    progress: float
    cancel_requested: bool
    feedback: dict[str, JsonValue] | None = None
    result: GoalResult | None


class Goals(ResponseModel):
    """The latest goals of a controller.

    Attributes:
        goals: The goals, oldest first.
    """

    goals: Items[Goal]


class TrajectoryRequest(RequestModel):
    """Let a controller follow a trajectory without a goal.

    Attributes:
        trajectory: trajectory_msgs/JointTrajectory with times in seconds; without
            points the joints stop and hold.
        epoch: Epoch it was made for; refused when a stop or reset came since.

    Example:
        {"trajectory": {"joint_names": ["panda_joint1", "panda_joint2"], "points":
         [{"positions": [0.3, -0.5], "time_from_start": 2.0}]}}
    """

    trajectory: ParameterValues
    epoch: int | None = Field(default=None, ge=0)


class DesiredState(ResponseModel):
    """Desired state of joints at a time, shape (n,) each.

    Attributes:
        name: The joints.
        position: [rad or m].
        velocity: [rad/s or m/s].
        acceleration: [rad/s^2 or m/s^2].
    """

    name: Items[str]
    position: Measurements
    velocity: Measurements
    acceleration: Measurements
