"""Limits of smoothed motion: the parameters, and what holds without them."""

from dataclasses import dataclass
from math import inf, isfinite
from typing import NoReturn

from station.core.description.robot_description import JointDescription
from station.core.errors import ParameterError
from station.core.parameters import Parameters

TIME_TO_SPEED = 0.5
"""Default acceleration: full velocity after about this time [s]."""
TIME_TO_ACCELERATION = 0.1
"""Default jerk: full acceleration after this time [s]."""
LEAD = 0.2
"""Default lead of a desired position, turning joints [rad]."""
LINEAR_LEAD = 0.05
"""The same for linear joints [m]."""


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Bounds of every joint, shape (n,) each, all finite and > 0.

    Attributes:
        velocity: [rad/s or m/s].
        acceleration: [rad/s^2 or m/s^2].
        jerk: [rad/s^3 or m/s^3].
    """

    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]


def read_motion_limits(
    params: Parameters, joints: list[JointDescription]
) -> MotionLimits:
    """Read `max_velocity`, `max_acceleration` and `max_jerk`.

    Each is one number for all joints or a list with one for each. Without
    `max_velocity` the limits of the robot description hold; the others are derived, see
    `TIME_TO_SPEED` and `TIME_TO_ACCELERATION`.

    Args:
        params: The controller's namespace.
        joints: The joints.

    Raises:
        ParameterError: A value is missing or impossible, or a velocity is beyond the
            joint's limit.
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
    return MotionLimits(tuple(velocity), tuple(acceleration), tuple(jerk))


def read_max_lead(params: Parameters, joints: list[JointDescription]) -> list[float]:
    """Read `max_lead`, how far a desired position may be ahead of the joint [rad or m].

    One number for all joints or a list with one for each; see `LEAD` without it.

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
        ParameterError: There are others.
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
        remedy="Give one number for all joints, or a list with one for each.",
        details={"parameter": params.resolve(key)},
    )
