"""Durations in a ring, and their percentiles."""

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.core.numerics.durations import Durations
from station.reports import Percentiles


class DurationRing(Durations):
    """Keep the last durations. One thread adds, any thread may ask for percentiles.

    Args:
        capacity: Number of durations that are kept.
    """

    def __init__(self, capacity: int = 16384) -> None:
        super().__init__(capacity)
        self._before = 0

    @property
    def added(self) -> int:
        """Number of durations ever added; a reset does not change it."""
        return self._before + self.count

    @override
    def reset(self) -> None:
        """Forget all durations; only the thread that adds may call this."""
        self._before += self.count
        super().reset()

    def percentiles(self) -> Percentiles:
        """Return the percentiles of the durations in the ring."""
        kept = np.array(self.values[: min(self.count, self.capacity)])
        return percentiles_of(kept, self.largest, self.count)


def percentiles_of(
    durations: NDArray[np.float64], largest: float, count: int
) -> Percentiles:
    """Return the percentiles of durations; they are sorted in place.

    Args:
        durations: The kept durations [s], shape (n,), n may be 0.
        largest: The largest one ever [s].
        count: How many there were.
    """
    if durations.size == 0:
        return Percentiles(0.0, 0.0, 0.0, 0.0, 0)
    # Not by np.percentile: its first call imports for 50 ms, beside the cycles.
    durations.sort()
    places = np.multiply((0.5, 0.99, 0.999), durations.size - 1)
    p50, p99, p999 = np.interp(places, np.arange(durations.size), durations).tolist()
    return Percentiles(p50, p99, p999, largest, count)
