"""Limits of smoothed Cartesian motion: parameters, defaults and bounds."""

from dataclasses import dataclass
from math import sqrt

from station.controllers.smoothed_motion.axis_limits import AxisLimits
from station.core.errors import ParameterError
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
        """Return limits along and about each axis that keep vectors within these."""
        three = [SHARE_OF_AN_AXIS] * 3
        both = (self.translation, self.rotation)
        return AxisLimits(
            velocity=tuple(each.velocity * s for each in both for s in three),
            acceleration=tuple(each.acceleration * s for each in both for s in three),
            jerk=tuple(each.jerk * s for each in both for s in three),
        )


def read_cartesian_limits(params: Parameters) -> CartesianLimits:
    """Read the limits `max_translational_…` and `max_rotational_…`.

    Args:
        params: The controller's namespace.

    Raises:
        ParameterError: A value is not above 0, or is larger than the arms allow.
    """
    return CartesianLimits(
        _read_vector(params, "translational", TRANSLATION, LARGEST_TRANSLATION),
        _read_vector(params, "rotational", ROTATION, LARGEST_ROTATION),
    )


def _read_vector(
    params: Parameters, kind: str, default: VectorLimits, largest: VectorLimits
) -> VectorLimits:
    def read(key: str, usual: float, bound: float) -> float:
        return _read(params, f"max_{kind}_{key}", usual, bound)

    return VectorLimits(
        read("velocity", default.velocity, largest.velocity),
        read("acceleration", default.acceleration, largest.acceleration),
        read("jerk", default.jerk, largest.jerk),
    )


def _read(params: Parameters, key: str, default: float, largest: float) -> float:
    value = params.get_float(key, default)
    if not 0.0 < value <= largest:
        raise ParameterError(
            f"Parameter '{params.resolve(key)}' is {value}; it must be above 0 and at "
            f"most {largest}.",
            remedy="Give a value in that range, or leave the parameter out.",
            details={"parameter": params.resolve(key)},
        )
    return value
