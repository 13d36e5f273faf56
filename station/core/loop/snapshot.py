"""What a cycle left behind, kept in a ring: one writer, any number of readers."""

from typing import NamedTuple

from station.core.control.controller import ControllerSample, unpack_sample
from station.core.hardware.interfaces.joint_group import Packed, unpack
from station.kernel.control_cycle import Records
from station.kernel.sample_columns import PackedColumns


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


Samples = dict[str, ControllerSample | PackedColumns]
Record = tuple[int, int, float, float, str, Packed, Samples]
"""A cycle as the control thread leaves it; what is packed still is."""


class SnapshotRing(Records):
    """Keeps the last `capacity` snapshots without a lock.

    The control thread puts one record in per cycle; a reader makes a snapshot of it. A
    reader copies references and then looks whether the writer has overtaken it, so that
    it either gets every cycle or learns how many it lost.

    Args:
        capacity: Number of snapshots kept, >= 2.
    """

    def __init__(self, capacity: int = 4096) -> None:
        super().__init__(capacity)

    def latest(self) -> Snapshot | None:
        """Return the newest snapshot, None before the first cycle."""
        latest = self.newest
        return None if latest is None else _unpack(latest)

    def read_since(self, cycle: int) -> tuple[list[Snapshot], int]:
        """Return the snapshots after `cycle`, oldest first, and how many were lost.

        Args:
            cycle: Number of the last cycle the reader has seen; 0 for none.
        """
        records, lost = self.records_since(cycle)
        return [_unpack(record) for record in records], lost

    def records_since(self, cycle: int) -> tuple[list[Record], int]:
        """Return the records after `cycle` as they are; see `read_since`.

        Args:
            cycle: Number of the last cycle the reader has seen; 0 for none.
        """
        latest = self.newest
        if latest is None or latest[0] <= cycle:
            return [], 0
        newest = latest[0]
        first = max(cycle + 1, newest - self.capacity + 1)
        found = [
            record
            for number in range(first, newest + 1)
            if (record := self.slots[number % self.capacity]) is not None
            and record[0] == number
        ]
        return found, newest - cycle - len(found)


def _unpack(record: Record) -> Snapshot:
    cycle, epoch, stamp, period, mode, packed, samples = record
    position, velocity, effort = unpack(packed)
    found = {name: unpack_sample(each) for name, each in samples.items()}
    return Snapshot(
        cycle, epoch, stamp, period, mode, position, velocity, effort, found
    )
