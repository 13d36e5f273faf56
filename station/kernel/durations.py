"""Durations in a ring, without allocation."""

from station.kernel.doubles import zeros


class Durations:
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
        self.place = 0
        self.count = 0
        self.largest = 0.0
        self.total = 0.0
        self.squares = 0.0

    def add(self, duration: float) -> None:
        """Add a duration [s]."""
        self.put(duration)

    def put(self, duration: float) -> None:
        """Add a duration [s]; for the kernel, which calls it without a look-up."""
        place = self.place
        self.values[place] = duration
        self.place = 0 if place + 1 == self.capacity else place + 1
        self.count += 1
        self.total += duration
        self.squares += duration * duration
        if duration > self.largest:
            self.largest = duration

    def reset(self) -> None:
        """Forget all durations; only the thread that adds may call this."""
        self.place = 0
        self.count = 0
        self.largest = 0.0
        self.total = 0.0
        self.squares = 0.0


class CycleTimes:
    """The durations of the parts of a cycle.

    Args:
        read: How long reading takes.
        update: How long the controllers take.
        write: How long writing takes.
        total: How long all of it takes.

    Attributes:
        last: When the last cycle ended [s].
    """

    def __init__(
        self, read: Durations, update: Durations, write: Durations, total: Durations
    ) -> None:
        self.read = read
        self.update = update
        self.write = write
        self.total = total
        self.last = 0.0

    def add(self, begun: float, read: float, updated: float, written: float) -> None:
        """Add a cycle.

        Args:
            begun: When the cycle began [s].
            read: When the robot had been read [s].
            updated: When the controllers had been updated [s].
            written: When the commands had been written [s].
        """
        self.read.put(read - begun)
        self.update.put(updated - read)
        self.write.put(written - updated)
        self.total.put(written - begun)
        self.last = written
