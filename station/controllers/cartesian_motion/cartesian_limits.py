"""Limits of smoothed Cartesian motion: parameters, defaults and bounds."""

from dataclasses import dataclass
from math import sqrt

from station.controllers.smoothed_motion.axis_limits import AxisLimits
from station.core.declared_parameter import DeclaredParameter, declare_number
from station.core.parameters import Parameters

SHARE_OF_AN_AXIS = 1.0 / sqrt(3.0)
"""Share of a limit for each of three axes, so that no vector exceeds the limit."""


@dataclass(frozen=True, slots=True)
class VectorLimits:
    """Bounds of the length of a vector, a translation or a rotation.

    Attributes:
        velocity: Largest velocity, > 0 [m/s or rad/s].
        acceleration: Largest acceleration, > 0 [m/s^2 or rad/s^2].
        jerk: Largest jerk, > 0 [m/s^3 or rad/s^3].
    """

    velocity: float
    acceleration: float
    jerk: float


TRANSLATION = VectorLimits(0.3, 1.0, 10.0)
"""Default limits of the end effector's translation."""
ROTATION = VectorLimits(1.0, 2.5, 25.0)
"""Default limits of the end effector's rotation."""
LARGEST_TRANSLATION = VectorLimits(1.7, 9.0, 4500.0)
"""Largest limits of the translation that both kinds of Franka arms allow.

Source: Franka Control Interface documentation, Robot and interface specifications.
"""
LARGEST_ROTATION = VectorLimits(2.5, 17.0, 8500.0)
"""Largest limits of the rotation that both kinds of Franka arms allow."""


@dataclass(frozen=True, slots=True)
class CartesianLimits:
    """Limits of a motion of the end effector.

    Attributes:
        translation: Limits of the motion of its origin.
        rotation: Limits of the change of its orientation.
    """

    translation: VectorLimits
    rotation: VectorLimits

    def of_axes(self) -> AxisLimits:
        """Return limits of each axis that keep vectors within the present limits."""
        three = [SHARE_OF_AN_AXIS] * 3
        both = (self.translation, self.rotation)
        return AxisLimits(
            velocity=tuple(each.velocity * s for each in both for s in three),
            acceleration=tuple(each.acceleration * s for each in both for s in three),
            jerk=tuple(each.jerk * s for each in both for s in three),
        )


_MEANINGS = {
    "max_translational_velocity": "largest speed of the end effector's origin",
    "max_translational_acceleration": "largest acceleration of the origin",
    "max_translational_jerk": "largest jerk of the origin",
    "max_rotational_velocity": "largest angular velocity of the end effector",
    "max_rotational_acceleration": "largest angular acceleration",
    "max_rotational_jerk": "largest angular jerk",
}


def _declare(
    kind: str, length: str, default: VectorLimits, largest: VectorLimits
) -> tuple[DeclaredParameter, ...]:
    orders = ((length + "/s", "velocity"), (length + "/s^2", "acceleration"))
    return tuple(
        declare_number(
            f"max_{kind}_{quantity}",
            _MEANINGS[f"max_{kind}_{quantity}"],
            float(getattr(default, quantity)),
            unit,
            minimum=0.0,
            excludes_minimum=True,
            maximum=float(getattr(largest, quantity)),
        )
        for unit, quantity in (*orders, (length + "/s^3", "jerk"))
    )


_OF_TRANSLATION = _declare("translational", "m", TRANSLATION, LARGEST_TRANSLATION)
_OF_ROTATION = _declare("rotational", "rad", ROTATION, LARGEST_ROTATION)
LIMIT_PARAMETERS = (*_OF_TRANSLATION, *_OF_ROTATION)
"""The parameters `max_translational_…` and `max_rotational_…`."""


def read_cartesian_limits(params: Parameters) -> CartesianLimits:
    """Read the limits `max_translational_…` and `max_rotational_…`.

    Args:
        params: The controller's namespace.

    Raises:
        ParameterError: A value is not above 0, or is larger than the arms allow.
    """
    return CartesianLimits(
        VectorLimits(*(each.read_float(params) for each in _OF_TRANSLATION)),
        VectorLimits(*(each.read_float(params) for each in _OF_ROTATION)),
    )
