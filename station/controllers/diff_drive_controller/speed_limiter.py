"""Limit a velocity, its acceleration and its jerk.

Source: ros_controllers@678b92a diff_drive_controller/src/speed_limiter.cpp,
SpeedLimiter.
"""

from dataclasses import dataclass
from math import inf

from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.errors import ParameterError
from station.core.parameters import Parameters

_KINDS = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True)
class SpeedLimiter:
    """The limits of one direction; infinite where there is none.

    Attributes:
        velocity: Smallest and largest velocity [m/s or rad/s].
        acceleration: Smallest and largest acceleration [m/s^2 or rad/s^2].
        jerk: Smallest and largest jerk [m/s^3 or rad/s^3].
    """

    velocity: tuple[float, float] = (-inf, inf)
    acceleration: tuple[float, float] = (-inf, inf)
    jerk: tuple[float, float] = (-inf, inf)

    def limit(self, wanted: float, last: float, before: float, period: float) -> float:
        """Return the velocity nearest to the wanted one that respects the limits.

        Args:
            wanted: [m/s or rad/s].
            last: The velocity of the last cycle.
            before: The velocity of the cycle before that.
            period: Duration of a cycle [s], >= 0.
        """
        change = wanted - last
        # The factor 2 is the original's; the jerk is half of what its name says.
        square = 2.0 * period * period
        if self.jerk != (-inf, inf):
            change_before = last - before
            bend = _clamp(change - change_before, self.jerk, square)
            change = change_before + bend
        if self.acceleration != (-inf, inf):
            change = _clamp(change, self.acceleration, period)
        low, high = self.velocity
        return min(max(last + change, low), high)


def limiter_parameters(axis: str, unit: str) -> tuple[DeclaredParameter, ...]:
    """Return the parameters of one direction.

    Args:
        axis: Its namespace, `linear/x` or `angular/z`.
        unit: Unit of its position.
    """
    found = []
    for kind, power in zip(_KINDS, ("s", "s^2", "s^3"), strict=True):
        found.append(
            DeclaredParameter(
                name=f"{axis}/has_{kind}_limits",
                type=ParameterType.BOOLEAN,
                default=False,
                description=f"whether the {kind} is limited",
            )
        )
        for end, text in (("max", "0"), ("min", f"-max_{kind}")):
            found.append(
                DeclaredParameter(
                    name=f"{axis}/{end}_{kind}",
                    type=ParameterType.NUMBER,
                    unit=f"{unit}/{power}",
                    default_text=text,
                    description=f"{'largest' if end == 'max' else 'smallest'} {kind}",
                )
            )
    return tuple(found)


def read_limiter(params: Parameters, axis: str) -> SpeedLimiter:
    """Return the limits of one direction.

    Args:
        params: The controller's namespace.
        axis: `linear/x` or `angular/z`.

    Raises:
        ParameterError: A value is no number, or a smallest value is above 0 or a
            largest one below.
    """
    inside = params.namespace(axis)
    return SpeedLimiter(*(_read_range(inside, kind) for kind in _KINDS))


def _read_range(params: Parameters, kind: str) -> tuple[float, float]:
    is_limited = params.get_bool(f"has_{kind}_limits", default=False)
    high = params.get_float(f"max_{kind}", 0.0)
    low = params.get_float(f"min_{kind}", -high)
    if not is_limited:
        return (-inf, inf)
    if not low <= 0.0 <= high:
        place = params.resolve(f"max_{kind}")
        raise ParameterError(
            f"Parameter '{place}' allows {low} to {high}; a range must contain 0.",
            remedy=f"Give max_{kind} >= 0 and min_{kind} <= 0.",
            details={"parameter": place},
        )
    return (low, high)


def _clamp(value: float, bounds: tuple[float, float], factor: float) -> float:
    return min(max(value, bounds[0] * factor), bounds[1] * factor)
