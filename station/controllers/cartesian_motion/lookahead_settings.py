"""Margins that Cartesian motion keeps from limits of the joints and from collisions."""

from dataclasses import dataclass

from station.core.declared_parameter import DeclaredParameter, ParameterType
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


def _declare(
    name: str, unit: str, bounds: tuple[float, float], description: str
) -> DeclaredParameter:
    return DeclaredParameter(
        name=name,
        type=ParameterType.NUMBER,
        unit=unit,
        default=float(getattr(_DEFAULT, name)),
        minimum=bounds[0],
        maximum=bounds[1],
        description=description,
    )


_DEFAULT = LookaheadSettings()
_MARGINS = (
    _declare(
        "joint_limit_margin",
        "rad",
        (0.0, 1.0),
        "distance to a joint's position limit at which the arm waits",
    ),
    _declare(
        "least_dexterity",
        "",
        (0.01, 1.0),
        "smallest singular value of the Jacobian at which the arm waits: 0 at a "
        "singular pose, about 0.2 in mid-range",
    ),
    _declare(
        "least_clearance",
        "m",
        (0.0, 0.3),
        "distance between two parts of the arm, hand included, at which the arm waits",
    ),
    _declare(
        "joint_velocity_share",
        "",
        (0.01, 1.0),
        "share of the joints' velocity limits that a motion may use",
    ),
)
_MAX_JOINT_ACCELERATION = DeclaredParameter(
    name="max_joint_acceleration",
    type=ParameterType.NUMBER_OR_NUMBERS,
    unit="rad/s^2",
    default=_DEFAULT.max_joint_acceleration,
    minimum=0.0,
    excludes_minimum=True,
    maximum=max(LARGEST_JOINT_ACCELERATION),
    size=len(LARGEST_JOINT_ACCELERATION),
    description="largest joint acceleration; one number, or seven; at most 10, "
    "joint 2: 7.5",
)
LOOKAHEAD_PARAMETERS = (*_MARGINS, _MAX_JOINT_ACCELERATION)
"""The parameters that are named after the attributes of `LookaheadSettings`."""


def read_lookahead_settings(params: Parameters) -> LookaheadSettings:
    """Read the parameters that are named after the attributes of the settings.

    `max_joint_acceleration` is one number for all joints, or a list with one number per
    joint.

    Args:
        params: The controller's namespace.

    Raises:
        ParameterError: A value is out of its range.
    """
    margins = {each.name: each.read_float(params) for each in _MARGINS}
    accelerations = _MAX_JOINT_ACCELERATION.read_per_axis(params)
    for value, bound in zip(accelerations, LARGEST_JOINT_ACCELERATION, strict=True):
        if value > bound:
            allowed = f"at most {list(LARGEST_JOINT_ACCELERATION)}"
            _MAX_JOINT_ACCELERATION.refuse(params, accelerations, allowed)
    return LookaheadSettings(**margins, max_joint_acceleration=tuple(accelerations))
