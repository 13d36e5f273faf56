"""Limit a value, its rate and the change of its rate, as control_toolbox does.

Source: control_toolbox@6.x rate_limiter.hpp, RateLimiter.
"""

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True, slots=True)
class RateLimiter:
    """The limits of one value; infinite where there is none.

    Attributes:
        value: Smallest and largest value.
        rate: Smallest and largest rate for a value above 0: braking and speeding up.
        reverse_rate: The same for a value below 0: speeding up and braking. At 0 the
            value may speed up both ways.
        jerk: Smallest and largest change of the rate. It counts only while the value
            speeds up.
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


def _clamp(value: float, bounds: tuple[float, float], factor: float) -> float:
    return min(max(value, bounds[0] * factor), bounds[1] * factor)
