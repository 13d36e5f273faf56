"""What a cycle left behind, kept in a ring: one writer, any number of readers."""

from typing import NamedTuple

from station.core.control.controller import ControllerSample


class Snapshot(NamedTuple):
    """The state after one cycle. Nobody changes it once it is in the ring.

    Attributes:
        cycle: Number of the cycle, from 1, without gaps.
        epoch: The station's epoch in that cycle.
        stamp: Station time [s].
        period: Time since the cycle before [s].
        mode: The robot's mode.
        position: Joint positions [rad or m], shape (n,), as `Station.joint_names`.
        velocity: Joint velocities [rad/s or m/s], shape (n,).
        effort: Joint efforts [Nm or N], shape (n,).
        samples: What each running controller did last, by name.
    """

    cycle: int
    epoch: int
    stamp: float
    period: float
    mode: str
    position: list[float]
    velocity: list[float]
    effort: list[float]
    samples: dict[str, ControllerSample]


class SnapshotRing:
    """Keeps the last `capacity` snapshots without a lock.

    The control thread puts one in per cycle. A reader copies references and then
    looks whether the writer has overtaken it, so that it either gets every cycle or
    learns how many it lost.

    Args:
        capacity: Number of snapshots kept, >= 2.
    """

    def __init__(self, capacity: int = 4096) -> None:
        self._capacity = capacity
        self._slots: list[Snapshot | None] = [None] * capacity
        self._latest: Snapshot | None = None

    def push(self, snapshot: Snapshot) -> None:
        """Add the next snapshot; control thread only, cycles without gaps."""
        self._slots[snapshot.cycle % self._capacity] = snapshot
        self._latest = snapshot

    def latest(self) -> Snapshot | None:
        """Return the newest snapshot, None before the first cycle."""
        return self._latest

    def read_since(self, cycle: int) -> tuple[list[Snapshot], int]:
        """Return the snapshots after `cycle`, oldest first, and how many were lost.

        Args:
            cycle: Number of the last cycle the reader has seen; 0 for none.
        """
        newest = self._latest
        if newest is None or newest.cycle <= cycle:
            return [], 0
        first = max(cycle + 1, newest.cycle - self._capacity + 1)
        found = [
            snapshot
            for number in range(first, newest.cycle + 1)
            if (snapshot := self._slots[number % self._capacity]) is not None
            and snapshot.cycle == number
        ]
        return found, newest.cycle - cycle - len(found)
