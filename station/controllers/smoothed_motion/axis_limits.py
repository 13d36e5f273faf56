"""Limits of smoothed motion: parameters and defaults."""

from dataclasses import dataclass
from math import inf, isfinite
from typing import NoReturn

from station.core.description.robot_description import JointDescription
from station.core.errors import ParameterError
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
    velocity = _read(params, "max_velocity", [joint.velocity for joint in joints])
    for value, joint in zip(velocity, joints, strict=True):
        if value > joint.velocity:
            _refuse(params, "max_velocity", value, f"<= {joint.velocity}")
    acceleration = _read(
        params, "max_acceleration", [each / TIME_TO_SPEED for each in velocity]
    )
    jerk = _read(
        params, "max_jerk", [each / TIME_TO_ACCELERATION for each in acceleration]
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
    return _read(params, "max_lead", default)


def _read(params: Parameters, key: str, default: list[float]) -> list[float]:
    """Return one positive number per joint.

    Raises:
        ParameterError: The numbers are too many, too few, or not positive and finite.
    """
    if not params.has(key):
        values = default
    elif isinstance(params.get(key), list):
        values = params.get_float_list(key)
    else:
        values = [params.get_float(key)] * len(default)
    if len(values) != len(default):
        _refuse(params, key, values, f"{len(default)} numbers, or one")
    for value in values:
        if not (isfinite(value) and value > 0.0):
            _refuse(params, key, "missing" if value == inf else value, "> 0")
    return values


def _refuse(params: Parameters, key: str, value: object, allowed: str) -> NoReturn:
    raise ParameterError(
        f"Parameter '{params.resolve(key)}' is {value}; it must be {allowed}.",
        remedy="Give one number for all joints, or a list with one number per joint.",
        details={"parameter": params.resolve(key)},
    )
