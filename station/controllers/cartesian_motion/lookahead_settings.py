"""How far Cartesian motion keeps away from what the joints cannot do."""

from dataclasses import dataclass

from station.core.errors import ParameterError
from station.core.parameters import Parameters


@dataclass(frozen=True, slots=True)
class LookaheadSettings:
    """What is kept free on the way.

    Attributes:
        joint_limit_margin: Distance to the position limits of the joints [rad], 0 to 1.
        least_dexterity: Smallest singular value of the Jacobian of the end effector and
            joint 3, 0.01 to 1; it is 0 at a singular pose, 0.2 in the middle.
        joint_velocity_share: Share of the joints' velocity limits, above 0, at most 1.
    """

    joint_limit_margin: float = 0.05
    least_dexterity: float = 0.05
    joint_velocity_share: float = 0.5


def read_lookahead_settings(params: Parameters) -> LookaheadSettings:
    """Read `joint_limit_margin`, `least_dexterity` and `joint_velocity_share`.

    Args:
        params: The controller's namespace.

    Raises:
        ParameterError: A value is out of its range.
    """
    default = LookaheadSettings()
    return LookaheadSettings(
        _read(params, "joint_limit_margin", default.joint_limit_margin, (0.0, 1.0)),
        _read(params, "least_dexterity", default.least_dexterity, (0.01, 1.0)),
        _read(
            params, "joint_velocity_share", default.joint_velocity_share, (0.01, 1.0)
        ),
    )


def _read(
    params: Parameters, key: str, default: float, bounds: tuple[float, float]
) -> float:
    value = params.get_float(key, default)
    if not bounds[0] <= value <= bounds[1]:
        raise ParameterError(
            f"Parameter '{params.resolve(key)}' is {value}; it must be between "
            f"{bounds[0]} and {bounds[1]}.",
            remedy="Give a value of that range, or leave it out.",
            details={"parameter": params.resolve(key)},
        )
    return value
