"""Durations in a ring without allocation, and their percentiles."""

import numpy as np
from numpy.typing import NDArray

from station.memory.doubles import zeros
from station.reports import Percentiles


class DurationRing:
    """The last durations. One thread adds, any thread may read.

    Args:
        capacity: Number of durations that are kept, >= 1.

    Attributes:
        values: The ring, shape (capacity,).
        count: Number of durations since the last reset.
        largest: Largest duration since the last reset [s].
        total: Sum of the durations since the last reset [s].
        squares: Sum of their squares [s^2].
    """

    def __init__(self, capacity: int = 16384) -> None:
        self.capacity = capacity
        self.values = zeros(capacity)
        self.before = self.count = 0
        self.reset()

    @property
    def added(self) -> int:
        """Number of durations ever added; a reset does not change it."""
        return self.before + self.count

    def reset(self) -> None:
        """Forget all durations; only the thread that adds may call this."""
        self.before += self.count
        self.place = 0
        self.count = 0
        self.largest = 0.0
        self.total = 0.0
        self.squares = 0.0

    def add(self, duration: float) -> None:
        """Add a duration [s]."""
        place = self.place
        self.values[place] = duration
        self.place = 0 if place + 1 == self.capacity else place + 1
        self.count += 1
        self.total += duration
        self.squares += duration * duration
        if duration > self.largest:
            self.largest = duration

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
        largest: The largest duration, kept or not [s].
        count: Number of durations, kept or not.
    """
    if durations.size == 0:
        return Percentiles(0.0, 0.0, 0.0, 0.0, 0)
    # np.percentile is not used: its first call imports for 50 ms, while cycles run.
    durations.sort()
    places = np.multiply((0.5, 0.99, 0.999), durations.size - 1)
    p50, p99, p999 = np.interp(places, np.arange(durations.size), durations).tolist()
    return Percentiles(p50, p99, p999, largest, count)


class CycleTimes:
    """Durations of the parts of the last cycles. One thread adds, any may read.

    Args:
        capacity: Number of cycles that are kept, >= 1.

    Attributes:
        rows: The ring, 4 durations [s] for each cycle: reading, updating the
            controllers, writing, and the whole cycle.
        count: Number of cycles since the last reset.
        longest_read, longest_update, longest_write, longest_total: Longest of each part
            since the last reset [s].
        last: When the last cycle ended [s].
    """

    def __init__(self, capacity: int = 16384) -> None:
        self.rows = zeros(4 * capacity)
        self.size = 4 * capacity
        self.last = 0.0
        self.reset()

    def reset(self) -> None:
        """Forget all cycles; only the thread that adds may call this."""
        self.at = 0
        self.count = 0
        self.longest_read = 0.0
        self.longest_update = 0.0
        self.longest_write = 0.0
        self.longest_total = 0.0

    def add(self, begun: float, read: float, updated: float, written: float) -> None:
        """Add a cycle.

        Args:
            begun: When the cycle began [s].
            read: When the robot had been read [s].
            updated: When the controllers had been updated [s].
            written: When the commands had been written [s].
        """
        rows, at = self.rows, self.at
        total = written - begun
        write = written - updated
        update = updated - read
        read = read - begun
        rows[at] = read
        rows[at + 1] = update
        rows[at + 2] = write
        rows[at + 3] = total
        at += 4
        self.at = 0 if at == self.size else at
        self.count += 1
        if read > self.longest_read:
            self.longest_read = read
        if update > self.longest_update:
            self.longest_update = update
        if write > self.longest_write:
            self.longest_write = write
        if total > self.longest_total:
            self.longest_total = total
        self.last = written
