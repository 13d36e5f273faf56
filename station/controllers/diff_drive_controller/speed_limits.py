"""Limits of a base's velocity in one direction, and their parameters.

Source: ros_controllers@678b92a diff_drive_controller/src/speed_limiter.cpp;
ros2_controllers@6.x diff_drive_controller/src/diff_drive_controller_parameter.yaml.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isnan

from station.core.declared_parameter import (
    DeclaredParameter,
    declare_boolean,
    declare_number,
)
from station.core.errors import ParameterError, show
from station.core.parameters import Parameters

_KINDS = ("velocity", "acceleration", "jerk")
_SIGNS = {
    **{f"max_{kind}": 1.0 for kind in _KINDS},
    **{f"min_{kind}": -1.0 for kind in _KINDS},
    "max_deceleration": -1.0,
    "max_acceleration_reverse": -1.0,
    "max_deceleration_reverse": 1.0,
}
"""Sign of each parameter that is a number."""
_ROS2_RATES = {
    "max_deceleration": "smallest acceleration while it drives forwards, <= 0",
    "max_acceleration_reverse": "smallest acceleration from 0 on backwards, <= 0",
    "max_deceleration_reverse": "largest acceleration while it drives backwards, >= 0",
}


@dataclass(frozen=True, slots=True)
class RateLimiter:
    """Limits of one value, as control_toolbox has them; infinite where there is none.

    Attributes:
        value: Smallest and largest value.
        rate: Smallest and largest rate for a value above 0: braking and speeding up.
        reverse_rate: The same for a value below 0: speeding up and braking. At 0 the
            value may speed up both ways.
        jerk: Smallest and largest change of the rate. It counts only while the value
            speeds up.

    Source:
        control_toolbox@6.x rate_limiter.hpp, RateLimiter.
    """

    value: tuple[float, float] = (-inf, inf)
    rate: tuple[float, float] = (-inf, inf)
    reverse_rate: tuple[float, float] = (-inf, inf)
    jerk: tuple[float, float] = (-inf, inf)

    def limit(self, wanted: float, last: float, before: float, period: float) -> float:
        """Return the value nearest to the wanted one that respects the limits.

        Args:
            wanted: The wanted value.
            last: The value of the last cycle.
            before: The value of the cycle before that.
            period: Duration of a cycle [s], > 0.
        """
        change, change_before = wanted - last, last - before
        if self.jerk != (-inf, inf) and (change - change_before) * change > 0.0:
            square = period * period
            bend = _clamp(change - change_before, self.jerk, square)
            change = change_before + bend
        rate = self.rate if last > 0.0 else self.reverse_rate
        if last == 0.0:
            rate = (self.reverse_rate[0], self.rate[1])
        if rate != (-inf, inf):
            change = _clamp(change, rate, period)
        return _clamp(last + change, self.value, 1.0)


@dataclass(frozen=True, slots=True)
class SpeedLimiter:
    """The limits of one direction; infinite where there is none.

    Attributes:
        velocity: Smallest and largest velocity [m/s or rad/s].
        acceleration: Smallest and largest acceleration [m/s^2 or rad/s^2].
        jerk: Smallest and largest jerk [m/s^3 or rad/s^3].

    Source:
        ros_controllers@678b92a diff_drive_controller/src/speed_limiter.cpp,
        SpeedLimiter.
    """

    velocity: tuple[float, float] = (-inf, inf)
    acceleration: tuple[float, float] = (-inf, inf)
    jerk: tuple[float, float] = (-inf, inf)

    def limit(self, wanted: float, last: float, before: float, period: float) -> float:
        """Return the velocity nearest to the wanted one that respects the limits.

        Args:
            wanted: The wanted velocity [m/s or rad/s].
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
            declare_boolean(
                f"{axis}/has_{kind}_limits",
                f"whether the {kind} is limited",
                default=False,
            )
        )
        for end, text in (("max", "0"), ("min", f"-max_{kind}")):
            found.append(
                declare_number(
                    f"{axis}/{end}_{kind}",
                    f"{'largest' if end == 'max' else 'smallest'} {kind}",
                    unit=f"{unit}/{power}",
                    default_text=text,
                )
            )
    for name, text in _ROS2_RATES.items():
        found.append(
            declare_number(
                f"{axis}/{name}",
                f"with left_wheel_names: {text}",
                unit=f"{unit}/s^2",
                default_text="that of the acceleration",
            )
        )
    return tuple(found)


def read_limiter(
    params: Parameters, axis: str, *, is_ros2: bool
) -> SpeedLimiter | RateLimiter:
    """Return the limits of one direction.

    In ROS a kind of limits holds with its `has_…_limits`, in ROS 2 if its largest value
    is a number and the flag, which version 4 has, is not false.

    Args:
        params: The controller's namespace.
        axis: `linear/x` or `angular/z`.
        is_ros2: Whether the parameters are those of ROS 2.

    Raises:
        ParameterError: A value is not a number, or one in force has the wrong sign.
    """
    inside = _below(params, axis)
    given = {name: _number(inside, name) for name in _SIGNS}
    is_on = {
        kind: inside.get_bool(f"has_{kind}_limits", default=is_ros2)
        and not (is_ros2 and given[f"max_{kind}"] is None)
        for kind in _KINDS
    }

    def bound(name: str, absent: float) -> float:
        value = given[name]
        if value is not None and value * _SIGNS[name] < 0.0:
            allowed = "0 or more" if _SIGNS[name] > 0.0 else "0 or less"
            raise ParameterError(
                f"Parameter '{inside.resolve(name)}' is {value:g}; it must be "
                f"{allowed}.",
                remedy="Correct the value, or leave the parameter out.",
                details={"parameter": inside.resolve(name)},
            )
        return absent if value is None else value

    def limits(kind: str) -> tuple[float, float]:
        if not is_on[kind]:
            return (-inf, inf)
        high = bound(f"max_{kind}", 0.0)
        return (bound(f"min_{kind}", -high), high)

    velocity, acceleration, jerk = map(limits, _KINDS)
    if not is_ros2:
        return SpeedLimiter(velocity, acceleration, jerk)
    rate = reverse_rate = acceleration
    if is_on["acceleration"]:
        low, high = acceleration
        reverse = bound("max_acceleration_reverse", low)
        rate = (bound("max_deceleration", reverse), high)
        reverse_rate = (reverse, bound("max_deceleration_reverse", high))
    return RateLimiter(velocity, rate, reverse_rate, jerk)


def _number(params: Parameters, name: str) -> float | None:
    """Return a limit; None if it is absent, or NaN as ROS 2 writes it."""
    value = params.get(name)
    absent = value is None or (isinstance(value, float) and isnan(value))
    return None if absent else params.get_float(name)


def _below(params: Parameters, axis: str) -> Parameters:
    """Return the namespace of the limits of one direction; it may be absent.

    Raises:
        ParameterError: Something else is in its place.
    """
    for key in (axis.partition("/")[0], axis):
        value = params.tree.get(params.resolve(key))
        if value is not None and not isinstance(value, Mapping):
            raise ParameterError(
                f"Parameter '{params.resolve(key)}' is {show(value)}; it must be a "
                "mapping of limits.",
                remedy="Write the limits below it, or leave the parameter out.",
                details={"parameter": params.resolve(key)},
            )
    return params.namespace(axis)


def _clamp(value: float, bounds: tuple[float, float], factor: float) -> float:
    return min(max(value, bounds[0] * factor), bounds[1] * factor)
