"""The speed along a path: ramps of bounded jerk between speeds that are held.

A ramp begins and ends without acceleration, so that it fits to a constant speed at both
ends. Lengths are in any unit [m or rad].
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True, slots=True)
class SpeedBounds:
    """Bounds of the speed along a path, all > 0.

    Attributes:
        speed: Largest speed.
        acceleration: Largest acceleration.
        jerk: Largest jerk.
    """

    speed: float
    acceleration: float
    jerk: float

    def reached_from(self, speed: float, length: float) -> float:
        """Return the largest speed that a ramp can reach, at most the bound.

        Args:
            speed: Speed at the beginning, >= 0; a ramp down to this speed has the same
                length.
            length: Length of the ramp, >= 0.
        """
        return _largest(speed, self.speed, lambda v: self.way(speed, v) <= length)

    def way(self, one: float, other: float) -> float:
        """Return the length of a ramp between two speeds."""
        return 0.5 * (one + other) * self.ramp_time(abs(other - one))

    def ramp_time(self, change: float) -> float:
        """Return the duration [s] of a ramp that changes the speed by `change`."""
        if change * self.jerk < self.acceleration * self.acceleration:
            return 2.0 * sqrt(change / self.jerk)
        return change / self.acceleration + self.acceleration / self.jerk

    def ramp(self, change: float) -> list[tuple[float, float]]:
        """Return duration [s] and jerk of each phase of a change of speed."""
        size, sign = abs(change), 1.0 if change > 0.0 else -1.0
        rise = min(sqrt(size / self.jerk), self.acceleration / self.jerk)
        level = self.ramp_time(size) - 2.0 * rise
        return [(rise, sign * self.jerk), (level, 0.0), (rise, -sign * self.jerk)]


@dataclass(frozen=True, slots=True)
class SpeedLaw:
    """The speed along a path.

    Attributes:
        speed: Speed at the beginning.
        phases: Duration [s] and jerk of each phase.
    """

    speed: float
    phases: list[tuple[float, float]]

    @classmethod
    def between(
        cls, begin: float, end: float, length: float, bounds: SpeedBounds
    ) -> "SpeedLaw":
        """Return the quickest law from one speed to another.

        Args:
            begin: Speed at the beginning.
            end: Speed at the end; a ramp of length `length` must be able to reach it.
            length: Length of the path, > 0.
            bounds: Bounds of the speed.
        """

        def ways(peak: float) -> float:
            return bounds.way(begin, peak) + bounds.way(peak, end)

        peak = _largest(max(begin, end), bounds.speed, lambda v: ways(v) <= length)
        cruise = max(length - ways(peak), 0.0) / peak
        ramps = bounds.ramp(peak - begin), bounds.ramp(end - peak)
        phases = [*ramps[0], (cruise, 0.0), *ramps[1]]
        return cls(begin, [phase for phase in phases if phase[0] > 0.0])

    @property
    def duration(self) -> float:
        """Return the time that the path takes [s]."""
        return sum(duration for duration, _ in self.phases)

    def at(self, time: float) -> tuple[float, float, float]:
        """Return the length covered, the speed and the acceleration at a time.

        Args:
            time: Time since the beginning [s], 0 to `duration`.
        """
        s, v, a = 0.0, self.speed, 0.0
        for duration, jerk in self.phases:
            t = min(duration, time)
            s += t * (v + t * (0.5 * a + t * jerk / 6.0))
            v += t * (a + 0.5 * t * jerk)
            a += t * jerk
            time -= t
            if time <= 0.0:
                break
        return s, v, a


def _largest(low: float, high: float, fits: Callable[[float], bool]) -> float:
    """Return the largest number for which a function is true; `low` if it never is."""
    if high <= low or fits(high):
        return high
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low
