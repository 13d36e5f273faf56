"""Limits of smoothed motion: parameters and defaults."""

from dataclasses import dataclass

from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.description.robot_description import JointDescription
from station.core.parameters import Parameters

TIME_TO_SPEED = 0.5
"""Default acceleration: full velocity is reached after about this time [s]."""
TIME_TO_ACCELERATION = 0.1
"""Default jerk: full acceleration is reached after this time [s]."""
LEAD = 0.2
"""Default of `max_lead` for rotating joints [rad]."""
LINEAR_LEAD = 0.05
"""Default of `max_lead` for linear joints [m]."""


@dataclass(frozen=True, slots=True)
class AxisLimits:
    """Bounds of every axis of a smoothed motion, shape (n,) each, all finite and > 0.

    The axes are joints, or the coordinates of a pose.

    Attributes:
        velocity: Largest velocity [rad/s or m/s].
        acceleration: Largest acceleration [rad/s^2 or m/s^2].
        jerk: Largest jerk [rad/s^3 or m/s^3].
    """

    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]


_PER_JOINT = "one number for all joints, or a list with one number per joint"


def _declare(
    name: str, unit: str, default_text: str, description: str
) -> DeclaredParameter:
    return DeclaredParameter(
        name=name,
        type=ParameterType.NUMBER_OR_NUMBERS,
        unit=unit,
        default_text=default_text,
        minimum=0.0,
        excludes_minimum=True,
        description=description,
    )


_MAX_VELOCITY = _declare(
    "max_velocity", "rad/s", "velocity limit", f"largest velocity; {_PER_JOINT}"
)
_MAX_ACCELERATION = _declare(
    "max_acceleration",
    "rad/s^2",
    f"full velocity after {TIME_TO_SPEED:g} s",
    "largest acceleration, likewise",
)
_MAX_JERK = _declare(
    "max_jerk",
    "rad/s^3",
    f"full acceleration after {TIME_TO_ACCELERATION:g} s",
    "largest jerk, likewise",
)
LIMIT_PARAMETERS = (_MAX_VELOCITY, _MAX_ACCELERATION, _MAX_JERK)
"""The parameters of the limits."""
MAX_LEAD = _declare(
    "max_lead",
    "rad",
    f"{LEAD:g}, or {LINEAR_LEAD:g} m",
    "largest distance of the desired position from a joint; one number, or a list",
)


def read_axis_limits(params: Parameters, joints: list[JointDescription]) -> AxisLimits:
    """Read `max_velocity`, `max_acceleration` and `max_jerk`.

    Each parameter is one number for all joints, or a list with one number per joint.
    The default of `max_velocity` is the limit in the robot description; the other two
    defaults follow from `TIME_TO_SPEED` and `TIME_TO_ACCELERATION`.

    Args:
        params: The controller's namespace.
        joints: The joints.

    Raises:
        ParameterError: A value is missing or not above 0, or a velocity is beyond the
            limit of its joint.
    """
    velocity = _MAX_VELOCITY.read_per_axis(params, [each.velocity for each in joints])
    for value, joint in zip(velocity, joints, strict=True):
        if value > joint.velocity:
            _MAX_VELOCITY.refuse(params, value, f"<= {joint.velocity}")
    acceleration = _MAX_ACCELERATION.read_per_axis(
        params, [each / TIME_TO_SPEED for each in velocity]
    )
    jerk = _MAX_JERK.read_per_axis(
        params, [each / TIME_TO_ACCELERATION for each in acceleration]
    )
    return AxisLimits(tuple(velocity), tuple(acceleration), tuple(jerk))


def read_max_lead(params: Parameters, joints: list[JointDescription]) -> list[float]:
    """Read `max_lead`, the allowed distance from a joint to its desired position.

    The parameter is one number for all joints, or a list with one number per joint
    [rad or m]; the defaults are `LEAD` and `LINEAR_LEAD`.

    Args:
        params: The controller's namespace.
        joints: The joints.

    Raises:
        ParameterError: A value is not above 0.
    """
    default = [LINEAR_LEAD if joint.is_linear() else LEAD for joint in joints]
    return MAX_LEAD.read_per_axis(params, default)
