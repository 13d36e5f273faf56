"""Margins that Cartesian motion keeps from limits of the joints and from collisions."""

from dataclasses import dataclass
from typing import NoReturn

from station.core.errors import ParameterError
from station.core.parameters import Parameters

LARGEST_JOINT_ACCELERATION = (10.0, 7.5, 10.0, 10.0, 10.0, 10.0, 10.0)
"""Largest joint accelerations that both kinds of Franka arms allow [rad/s^2].

Source: Franka Control Interface documentation, Robot and interface specifications.
"""


@dataclass(frozen=True, slots=True)
class LookaheadSettings:
    """Margins that a motion keeps.

    Attributes:
        joint_limit_margin: Smallest distance to the position limits of the joints
            [rad], 0 to 1.
        least_dexterity: Smallest value allowed of `ArmConfiguration.dexterity`, 0.01 to
            1. The dexterity is 0 at a singular pose, and about 0.2 in the middle of the
            workspace.
        least_clearance: Smallest distance between two parts of the arm [m], 0 to 0.3.
        joint_velocity_share: Share of the joints' velocity limits that a motion may
            use, 0.01 to 1.
        max_joint_acceleration: Largest acceleration of each joint [rad/s^2], shape
            (7,), above 0 and at most `LARGEST_JOINT_ACCELERATION`.
    """

    joint_limit_margin: float = 0.05
    least_dexterity: float = 0.05
    least_clearance: float = 0.05
    joint_velocity_share: float = 0.5
    max_joint_acceleration: tuple[float, ...] = (7.0, 5.0, 7.0, 7.0, 7.0, 7.0, 7.0)


def read_lookahead_settings(params: Parameters) -> LookaheadSettings:
    """Read the parameters that are named after the attributes of the settings.

    `max_joint_acceleration` is one number for all joints, or a list with one number per
    joint.

    Args:
        params: The controller's namespace.

    Raises:
        ParameterError: A value is out of its range.
    """
    default = LookaheadSettings()
    return LookaheadSettings(
        _read(params, "joint_limit_margin", default.joint_limit_margin, (0.0, 1.0)),
        _read(params, "least_dexterity", default.least_dexterity, (0.01, 1.0)),
        _read(params, "least_clearance", default.least_clearance, (0.0, 0.3)),
        _read(
            params, "joint_velocity_share", default.joint_velocity_share, (0.01, 1.0)
        ),
        _read_accelerations(params, list(default.max_joint_acceleration)),
    )


def _read(
    params: Parameters, key: str, default: float, bounds: tuple[float, float]
) -> float:
    value = params.get_float(key, default)
    if not bounds[0] <= value <= bounds[1]:
        _refuse(params, key, value, f"between {bounds[0]} and {bounds[1]}")
    return value


def _read_accelerations(params: Parameters, default: list[float]) -> tuple[float, ...]:
    key, largest = "max_joint_acceleration", LARGEST_JOINT_ACCELERATION
    if params.has(key) and not isinstance(params.get(key), list):
        values = [params.get_float(key)] * len(largest)
    else:
        values = params.get_float_list(key, len(largest), default)
    for value, bound in zip(values, largest, strict=True):
        if not 0.0 < value <= bound:
            _refuse(params, key, values, f"above 0 and at most {list(largest)}")
    return tuple(values)


def _refuse(params: Parameters, key: str, value: object, allowed: str) -> NoReturn:
    raise ParameterError(
        f"Parameter '{params.resolve(key)}' is {value}; it must be {allowed}.",
        remedy="Give a value in that range, or leave the parameter out.",
        details={"parameter": params.resolve(key)},
    )
