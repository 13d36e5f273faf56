"""Set-points that are twists: a velocity, then an angular velocity."""

from math import sqrt

from typing_extensions import override

from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits
from station.core.errors import InvalidCommandError
from station.core.ports.set_point import SetPointElement, SetPointPort

_ROUNDING = 1e-9


class TwistSetPointPort(SetPointPort):
    """Takes `vx vy vz` [m/s] and `wx wy wz` [rad/s]; each vector has a length limit.

    Args:
        limits: Limits of the lengths of both vectors.
        timeout: How long a set-point is valid [s].
        longest: Longest validity that a set-point may ask for [s].
    """

    def __init__(
        self, limits: CartesianLimits, *, timeout: float, longest: float
    ) -> None:
        v, w = limits.translation.velocity, limits.rotation.velocity
        super().__init__(
            [
                *(SetPointElement(f"v{axis}", "m/s", -v, v) for axis in "xyz"),
                *(SetPointElement(f"w{axis}", "rad/s", -w, w) for axis in "xyz"),
            ],
            timeout=timeout,
            longest=longest,
        )
        self._bounds = (v, w)

    @override
    def check(
        self,
        values: list[float],
        timeout: float | None = None,
        rates: list[float] | None = None,
    ) -> None:
        """Refuse a malformed set-point, and a vector that is too long.

        Raises:
            InvalidCommandError: As in `SetPointPort.check`, or a vector is too long.
        """
        super().check(values, timeout, rates)
        for part, bound, unit in zip(
            (values[:3], values[3:6]), self._bounds, ("m/s", "rad/s"), strict=True
        ):
            length = sqrt(sum(value * value for value in part))
            if length > bound * (1.0 + _ROUNDING):
                raise InvalidCommandError(
                    f"The velocity {part} of the command is {length:.4g} {unit} long; "
                    f"allowed is at most {bound} {unit}.",
                    remedy="Divide the three numbers by the same factor.",
                    details={"length": length, "maximum": bound},
                )
