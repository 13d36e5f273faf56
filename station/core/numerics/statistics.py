"""Durations in a ring, and their percentiles."""

from array import array
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Percentiles:
    """Percentiles of the durations in a ring [s]; zeros if it is empty.

    Attributes:
        p50: Median.
        p99: Bound of 99 % of the durations.
        p999: Bound of 99.9 % of the durations.
        max: Largest duration since the last reset, even if it has left the ring.
        count: Number of durations since the last reset.
    """

    p50: float
    p99: float
    p999: float
    max: float
    count: int


class DurationRing:
    """Keep the last durations. One thread adds, any thread may ask for percentiles.

    Args:
        capacity: Number of durations that are kept.
    """

    def __init__(self, capacity: int = 16384) -> None:
        self._capacity = capacity
        self._values = array("d", bytes(8 * capacity))
        self._count = 0
        self._max = 0.0

    def add(self, duration: float) -> None:
        """Add a duration [s]."""
        self._values[self._count % self._capacity] = duration
        self._count += 1
        if duration > self._max:
            self._max = duration

    def reset(self) -> None:
        """Forget all durations; only the thread that adds may call this."""
        self._count = 0
        self._max = 0.0

    def percentiles(self) -> Percentiles:
        """Return the percentiles of the durations in the ring."""
        count = self._count
        values = np.array(self._values[: min(count, self._capacity)])
        if values.size == 0:
            return Percentiles(0.0, 0.0, 0.0, 0.0, 0)
        p50, p99, p999 = np.percentile(values, (50.0, 99.0, 99.9))
        return Percentiles(float(p50), float(p99), float(p999), self._max, count)
