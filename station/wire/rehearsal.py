"""Wire models of rehearsals."""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from station.wire.base import ControllerName, FileName, ParameterValues, RequestModel
from station.wire.library import PlayRequest

_Seconds = Annotated[float, Field(ge=0.0, le=60.0, allow_inf_nan=False)]
_LEAST = 1e-6
"""A quaternion whose numbers are all smaller than this counts as 0, and is refused."""
_Numbers = list[Annotated[float, Field(allow_inf_nan=False)]]


class _Step(RequestModel):
    """The base of all steps.

    Attributes:
        at: Time at which it is carried out [s since the beginning].
    """

    at: _Seconds = 0.0

    def as_input(self) -> dict[str, Any]:
        """Return the step as an input of the station."""
        return self.model_dump()


class SetPointStep(_Step):
    """A set-point for a running controller.

    Attributes:
        kind: `set_point`.
        name: The controller.
        values: One number per element; null leaves an element at its last command.
        timeout: How long it is valid [s]; the controller's own when null.
        rates: Rates of change of the elements; null without.
        at: Time at which it is carried out [s since the beginning].
    """

    kind: Literal["set_point"]
    name: ControllerName
    values: list[float | None] = Field(max_length=1024)
    timeout: float | None = Field(default=None, ge=0.0, le=3600.0)
    rates: _Numbers | None = Field(default=None, max_length=1024)


class GoalStep(_Step):
    """A goal for a running controller.

    Attributes:
        kind: `goal`.
        name: The controller.
        request: The goal message of the controller's action.
        at: Time at which it is carried out [s since the beginning].
    """

    kind: Literal["goal"]
    name: ControllerName
    request: ParameterValues


class TrajectoryStep(_Step):
    """A trajectory without a goal for a running controller.

    Attributes:
        kind: `trajectory`.
        name: The controller.
        request: trajectory_msgs/JointTrajectory with times in seconds.
        at: Time at which it is carried out [s since the beginning].
    """

    kind: Literal["trajectory"]
    name: ControllerName
    request: ParameterValues


class SwitchStep(_Step):
    """A switch of controllers in one cycle.

    Attributes:
        kind: `switch`.
        start: Names to start.
        stop: Names to stop.
        at: Time at which it is carried out [s since the beginning].
    """

    kind: Literal["switch"]
    start: list[str] = Field(default_factory=list, max_length=64)
    stop: list[str] = Field(default_factory=list, max_length=64)


class GainsStep(_Step):
    """A change of gains in one cycle.

    Attributes:
        kind: `gains`.
        changes: New values by controller and name.
        at: Time at which it is carried out [s since the beginning].
    """

    kind: Literal["gains"]
    changes: dict[str, dict[str, float]] = Field(min_length=1, max_length=64)


class PathStep(_Step):
    """One round of a saved waypoint path.

    Attributes:
        kind: `path`.
        path: Name of the path.
        options: The options with which it is played.
        at: Time at which it is carried out [s since the beginning].
    """

    kind: Literal["path"]
    path: FileName
    options: PlayRequest = Field(default_factory=PlayRequest)


RehearsalStep = Annotated[
    SetPointStep | GoalStep | TrajectoryStep | SwitchStep | GainsStep | PathStep,
    Field(discriminator="kind"),
]
"""One step of a rehearsal."""


class Place(RequestModel):
    """A pose of a Franka's end effector EE in the frame of the arm's base O.

    Attributes:
        position: Position of EE's origin, x, y, z [m].
        orientation: Quaternion x, y, z, w of EE; null keeps the present one.
        rpy: Roll, pitch and yaw of EE [rad], in place of `orientation`.
    """

    position: _Numbers = Field(min_length=3, max_length=3)
    orientation: _Numbers | None = Field(default=None, min_length=4, max_length=4)
    rpy: _Numbers | None = Field(default=None, min_length=3, max_length=3)

    def quaternion(self) -> list[float] | None:
        """Return the orientation as a quaternion x, y, z, w; None to keep it."""
        if self.rpy is None:
            return self.orientation
        (cr, sr), (cp, sp), (cy, sy) = (
            (math.cos(angle / 2.0), math.sin(angle / 2.0)) for angle in self.rpy
        )
        return [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ]

    @field_validator("orientation")
    @classmethod
    def _is_a_rotation(cls, value: list[float] | None) -> list[float] | None:
        if value is not None and max(map(abs, value)) < _LEAST:
            raise ValueError("must not be 0")
        return value


class PlanRequest(RequestModel):
    """Search for a path without collisions to one of three kinds of target.

    Attributes:
        controller: A running trajectory controller.
        positions: Target positions [rad or m], by joint; others stay.
        pose: Target pose of the end effector; the station computes the joints.
        name: A named pose of the robot, such as `ready`.
        timeout: How long to search [s], above 0 and at most 30.
        seed: Seed of the random numbers, 0 or more; another seed finds another path.

    Example:
        {"controller": "position_joint_trajectory_controller", "positions":
         {"panda_joint1": 0.5}}
    """

    controller: ControllerName
    positions: dict[str, Annotated[float, Field(allow_inf_nan=False)]] | None = Field(
        default=None, min_length=1, max_length=64
    )
    pose: Place | None = None
    name: str | None = Field(default=None, min_length=1, max_length=128)
    timeout: float = Field(default=2.0, gt=0.0, le=30.0)
    seed: int = Field(default=0, ge=0)

    @model_validator(mode="after")
    def _has_one_target(self) -> Self:
        given = [one for one in (self.positions, self.pose, self.name) if one]
        if len(given) != 1:
            raise ValueError("needs one of positions, pose and name")
        return self


class RehearsalRequest(RequestModel):
    """Try steps in a copy of the station; nothing moves.

    Attributes:
        steps: The steps; without steps the copy goes on as the station does now.
        seconds: How long the rehearsal lasts [s]; null ends it when all goals have
            ended and the joints stand still, after 30 s at the latest.
        certificate: Ask for a certificate, with which the commands are carried out as
            they were rehearsed.

    Example:
        {"steps": [{"kind": "goal", "name": "arm", "request": {"trajectory":
         {"joint_names": ["panda_joint1"], "points": [{"positions": [0.3],
         "time_from_start": 2.0}]}}}], "certificate": true}
    """

    steps: list[RehearsalStep] = Field(default_factory=list, max_length=50)
    seconds: Annotated[float, Field(gt=0.0, le=60.0)] | None = None
    certificate: bool = False

    @model_validator(mode="after")
    def _has_a_command(self) -> Self:
        if self.certificate and not self.steps:
            raise ValueError("needs a step for a certificate")
        return self
