"""Bounds of a joint's distance from its trajectory, on the way and at the goal.

Source: ros_controllers@678b92a joint_trajectory_controller/include/
joint_trajectory_controller/tolerances.h.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from station.core.declared_parameter import EACH_JOINT, declare_number
from station.core.numerics.joint_errors import first_excess
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, doubles

_GOAL_TIME = declare_number(
    "goal_time",
    "time after the end of a trajectory within which the joints must arrive",
    0.0,
    "s",
)
_PATH = declare_number(
    f"{EACH_JOINT}/trajectory",
    "largest error during the motion; 0: no bound",
    0.0,
    "rad",
)
_GOAL = declare_number(
    f"{EACH_JOINT}/goal", "largest error at the end; 0: no bound", 0.0, "rad"
)
STOPPED_VELOCITY_TOLERANCE = 0.01
"""Default speed below which a joint counts as stopped [rad/s or m/s]."""
_STOPPED = declare_number(
    "stopped_velocity_tolerance",
    "largest velocity at the end that counts as standing still",
    STOPPED_VELOCITY_TOLERANCE,
    "rad/s",
)
TOLERANCE_PARAMETERS = (_GOAL_TIME, _STOPPED, _PATH, _GOAL)
"""The parameters of the default bounds, in the namespace `constraints`."""

_QUANTITIES = ("position", "velocity", "acceleration")


@dataclass(frozen=True, slots=True)
class StateTolerances:
    """Bounds of the error of one joint; 0 means unbounded.

    Attributes:
        position: Largest position error [rad or m].
        velocity: Largest velocity error [rad/s or m/s].
        acceleration: Largest acceleration error [rad/s^2 or m/s^2].
    """

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def limits(self) -> Doubles:
        """Return the bounds, shape (3,); inf where there is none."""
        bounds = (self.position, self.velocity, self.acceleration)
        return doubles(bound if bound > 0.0 else inf for bound in bounds)

    def violation(
        self, position: float, velocity: float, acceleration: float = 0.0
    ) -> tuple[str, float, float] | None:
        """Return the first error that is too large, or None if all are within bounds.

        Args:
            position: Position error [rad or m].
            velocity: Velocity error [rad/s or m/s].
            acceleration: Acceleration error [rad/s^2 or m/s^2].

        Returns:
            Name of the quantity, its error, and its bound.
        """
        errors, limits = doubles((position, velocity, acceleration)), self.limits()
        found = first_excess(errors, limits)
        return None if found < 0 else (_QUANTITIES[found], errors[found], limits[found])


@dataclass(frozen=True, slots=True)
class JointTolerances:
    """The bounds of one joint.

    Attributes:
        path: Bounds while the joint follows the trajectory.
        goal: Bounds at the end.
        goal_time: Extra time after the end within which the bounds of the goal must be
            reached [s].
    """

    path: StateTolerances = StateTolerances()
    goal: StateTolerances = StateTolerances()
    goal_time: float = 0.0

    def with_wider_goal(self, offset: float) -> "JointTolerances":
        """Return the bounds with a larger position bound at the end, if it has one.

        Args:
            offset: Addition to the position bound [rad or m], >= 0.
        """
        if self.goal.position <= 0.0 or offset == 0.0:
            return self
        position = self.goal.position + offset
        return replace(self, goal=replace(self.goal, position=position))


@dataclass(frozen=True, slots=True)
class ToleranceRequest:
    """The bounds that a goal requests for one joint in place of the defaults.

    A positive number is the bound, a negative one removes the bound, zero keeps the
    default.

    Attributes:
        name: Name of the joint.
        position: Position error [rad or m].
        velocity: Velocity error [rad/s or m/s].
        acceleration: Acceleration error [rad/s^2 or m/s^2].
    """

    name: str
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0


def updated_value(default: float, requested: float) -> float:
    """Return a bound after a request, by the rule of `ToleranceRequest`.

    Args:
        default: The bound without a request.
        requested: The requested number.
    """
    if requested > 0.0:
        return requested
    return 0.0 if requested < 0.0 else default


def updated_tolerances(
    defaults: Mapping[str, JointTolerances],
    path: Sequence[ToleranceRequest],
    goal: Sequence[ToleranceRequest],
    goal_time: float,
) -> dict[str, JointTolerances]:
    """Return the bounds of every joint after the requests of a goal.

    Args:
        defaults: Bounds by joint name.
        path: Requests for the path; requests for other joints are ignored.
        goal: Requests for the goal; requests for other joints are ignored.
        goal_time: Requested extra time [s], by the same rule.
    """
    updated = {
        name: replace(each, goal_time=updated_value(each.goal_time, goal_time))
        for name, each in defaults.items()
    }
    for request in path:
        if request.name in updated:
            each = updated[request.name]
            updated[request.name] = replace(each, path=_updated(each.path, request))
    for request in goal:
        if request.name in updated:
            each = updated[request.name]
            updated[request.name] = replace(each, goal=_updated(each.goal, request))
    return updated


def read_tolerances(
    params: Parameters, joints: Sequence[str]
) -> dict[str, JointTolerances]:
    """Read the default bounds of every joint.

    Args:
        params: The namespace `constraints` of the controller: `goal_time`,
            `stopped_velocity_tolerance`, and per joint `trajectory` and `goal`.
        joints: The joints.

    Raises:
        ParameterError: A value is not a number.
    """
    goal_time = _GOAL_TIME.read_float(params)
    stopped = _STOPPED.read_float(params)
    return {
        name: JointTolerances(
            path=StateTolerances(_PATH.of(name).read_float(params)),
            goal=StateTolerances(_GOAL.of(name).read_float(params), stopped),
            goal_time=goal_time,
        )
        for name in joints
    }


def _updated(default: StateTolerances, request: ToleranceRequest) -> StateTolerances:
    return StateTolerances(
        updated_value(default.position, request.position),
        updated_value(default.velocity, request.velocity),
        updated_value(default.acceleration, request.acceleration),
    )
