"""Snapshots of cycles, kept in a ring: one writer, any number of readers."""

from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from math import isnan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from station.core.control.controller import (
    ControllerSample,
    ControllerState,
    unpack_sample,
)
from station.core.control.loaded_controller import LoadedController
from station.core.control.sample_columns import Column, PackedColumns
from station.memory.doubles import Doubles, zeros
from station.memory.vectors import copy_into

HEAD = 4
"""Count of the numbers in a row before the states of the joints."""
_HEAD = HEAD
# As the station time of a sample it says that the controller has left none.
_NAN = float("nan")
_RUNNING = ControllerState.RUNNING

Layout = tuple[tuple[str, int, int, int], ...]
"""The place of each sample in a row: name of the controller, index of the sample, its
number of doubles, and the length n of each of its first four columns. A sample is its
station time, then its columns. The index is -1 for a sample that is an object."""


class Snapshot(NamedTuple):
    """The state after one cycle. It never changes once it is in the ring.

    Attributes:
        cycle: Number of the cycle, from 1, without gaps.
        epoch: The station's epoch in that cycle.
        stamp: Station time [s].
        period: Time since the cycle before [s].
        mode: The robot's mode.
        position: Joint positions [rad or m], shape (n,), as `Station.joint_names`.
        velocity: Joint velocities [rad/s or m/s], shape (n,).
        effort: Joint efforts [Nm or N], shape (n,).
        samples: Last sample of each running controller, by name.
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
Record = tuple[int, int, float, float, str, bytes, Samples]
"""A snapshot whose joint states are still bytes of doubles: positions, velocities and
efforts one after the other."""


@dataclass(frozen=True, slots=True)
class Rows:
    """Cycles as the control thread has left them, k of them.

    Attributes:
        numbers: The rows, see `SnapshotRing`, shape (k, width).
        states: Count of the numbers in a row that are states of joints, 3 n.
        modes: The robot's mode in each cycle.
        layouts: Places of the samples in each row.
        objects: Samples that are objects, by name, in each cycle.
        lost: Number of requested cycles that were already overwritten.
    """

    numbers: NDArray[np.float64]
    states: int
    modes: list[str]
    layouts: list[Layout]
    objects: list[dict[str, object] | None]
    lost: int

    def __len__(self) -> int:
        return len(self.modes)

    @property
    def newest(self) -> int:
        """Number of the last cycle; there must be at least one cycle."""
        return int(self.numbers[len(self) - 1, 0])

    def time_of(self, cycle: int) -> float:
        """Return the station time of `cycle` [s].

        Args:
            cycle: Number of the cycle. For a missing cycle, the time of the first one
                after it is returned; for a future cycle, that of the last one.
        """
        index = int(np.searchsorted(self.numbers[:, 0], cycle))
        return float(self.numbers[min(index, len(self) - 1), 2])

    def states_of_joints(self) -> NDArray[np.float64]:
        """Return positions, velocities and efforts, shape (k, 3, n)."""
        states = self.numbers[:, HEAD : HEAD + self.states]
        return states.reshape(len(states), 3, -1)

    def columns_of(self, controller: str, size: int) -> NDArray[np.float64]:
        """Return the first four columns of a controller's samples, shape (k, 4, n).

        The columns are NaN in cycles in which the controller did not run, or in which
        they have another length.

        Args:
            controller: Its name.
            size: Length n of each column.
        """
        found = np.full((len(self.layouts), 4 * size), np.nan)
        # A layout stays the same until other controllers run.
        for _, group in groupby(range(len(found)), lambda k: id(self.layouts[k])):
            rows = list(group)
            for name, place, _, length in self.layouts[rows[0]]:
                if name != controller:
                    continue
                if place < 0:
                    self._copy_objects(controller, rows, found)
                elif length == size:
                    at = HEAD + self.states + place
                    ran = [k for k in rows if not isnan(self.numbers[k, at])]
                    found[ran] = self.numbers[ran, at + 1 : at + 1 + 4 * size]
        return found.reshape(len(found), 4, size)

    def _copy_objects(
        self, controller: str, rows: list[int], found: NDArray[np.float64]
    ) -> None:
        for k in rows:
            *_, samples = self.record(k)
            sample = samples.get(controller)
            memory = b"" if sample is None else unpack_sample(sample).memory()
            if len(memory) == found[k].nbytes:
                found[k] = np.frombuffer(memory)

    def record(self, index: int) -> Record:
        """Return the record of the cycle at an index."""
        row = self.numbers[index]
        cycle, epoch, stamp, period = row[:HEAD].tolist()
        samples: Samples = {}
        begin = HEAD + self.states
        objects = self.objects[index] or {}
        for name, place, width, size in self.layouts[index]:
            if place < 0:
                sample = objects.get(name)
                if isinstance(sample, (ControllerSample, tuple)):
                    samples[name] = sample
                continue
            at = begin + place
            if not isnan(row[at]):
                columns = row[at + 1 : at + width].tobytes()
                samples[name] = (float(row[at]), columns, size)
        states = row[HEAD:begin].tobytes()
        mode = self.modes[index]
        return int(cycle), int(epoch), stamp, period, mode, states, samples


class SnapshotRing:
    """Keeps the last `capacity` cycles without a lock, in memory that is made once.

    The control thread leaves one row of doubles per cycle: number of the cycle, epoch,
    station time [s], period [s], then the states of the joints, then the samples of
    controllers. A reader copies rows, then checks that the writer has not overtaken it:
    a row is whole if its first number is that of the cycle. So a reader either gets
    every cycle or learns how many it lost.

    Args:
        capacity: Number of cycles kept, >= 2.

    Attributes:
        newest: Number of the newest cycle, 0 before the first one.
    """

    def __init__(self, capacity: int = 4096) -> None:
        self.capacity = capacity
        # For each row: the robot's mode, the layout, and the samples that are objects.
        self.modes: list[str] = [""] * capacity
        self.layouts: list[Layout] = [()] * capacity
        self.objects: list[dict[str, object] | None] = [None] * capacity
        self.prepare([], 0)

    def prepare(self, blocks: Sequence[Doubles], room: int) -> None:
        """Forget all cycles, and make memory for new ones.

        Args:
            blocks: Memory of the joints' states, one block after the other.
            room: Number of doubles for samples in a row.
        """
        self.blocks = [Column(values) for values in blocks]
        self.states = sum(len(values) for values in blocks)
        self.room = room
        self.width = _HEAD + self.states + room
        self.memory = zeros(self.capacity * self.width)
        self.rows = self.memory
        self.newest = 0
        self.running: tuple[LoadedController, ...] = ()
        self.layout: Layout = ()

    def leave_row(
        self,
        cycle: int,
        epoch: int,
        time: float,
        period: float,
        mode: str,
        running: tuple[LoadedController, ...],
    ) -> None:
        """Leave a row of a cycle: joints, and the sample of each running controller.

        Control thread only, cycles without gaps.

        Args:
            cycle: Number of the cycle.
            epoch: The station's epoch.
            time: Station time [s].
            period: Time since the last cycle [s].
            mode: The robot's mode.
            running: The controllers that ran when the owners of commands were noted
                last. A new tuple means that the owners were noted anew.
        """
        if running is not self.running:
            self._lay_out(running)
        slot = cycle % self.capacity
        begin = slot * self.width
        rows = self.rows
        rows[begin] = 0.0  # readers must not take the row for whole
        self.modes[slot] = mode
        rows[begin + 1] = epoch
        rows[begin + 2] = time
        rows[begin + 3] = period
        at = begin + _HEAD
        for block in self.blocks:
            copy_into(rows, at, block.values, block.size)
            at += block.size
        # Made only if needed: a cycle with packed samples allocates nothing.
        objects: dict[str, object] | None = None
        for one in running:
            is_running = one.controller.state is _RUNNING
            sampled = one.sampled
            if sampled is not None and one.place >= 0:
                copy_into(rows, at + one.place, sampled.row, sampled.width)
                # If it stopped in this cycle, the bytes are those of the cycle before.
                if not is_running:
                    rows[at + one.place] = _NAN
            elif is_running:
                sample = one.controller.sample if sampled is None else sampled.newest
                if sample is not None:
                    if objects is None:
                        objects = {}
                    objects[one.info.name] = sample
        self.layouts[slot] = self.layout
        self.objects[slot] = objects
        # The number is written last: with it, readers take the row for whole.
        rows[begin] = cycle
        self.newest = cycle

    def _lay_out(self, running: tuple[LoadedController, ...]) -> None:
        """Find a place in the rows for the columns of each controller."""
        layout: list[tuple[str, int, int, int]] = []
        at = 0
        for one in running:
            one.place, width, size = -1, 0, 0
            sampled = one.sampled
            # A row has a fixed width: samples that do not fit are kept as objects.
            if sampled is not None and at + sampled.width <= self.room:
                one.place, width, size = at, sampled.width, sampled.size
                at += width
            layout.append((one.info.name, one.place, width, size))
        self.running, self.layout = running, tuple(layout)

    def latest(self) -> Snapshot | None:
        """Return the newest snapshot, None before the first cycle."""
        # The writer may overtake a reader that is slow; it then tries again.
        while newest := self.newest:
            found, _ = self.read_since(newest - 1)
            if found:  # otherwise it has been overwritten meanwhile
                return found[len(found) - 1]
        return None

    def read_since(self, cycle: int) -> tuple[list[Snapshot], int]:
        """Return the snapshots after `cycle`, oldest first, and the number lost.

        Args:
            cycle: Number of the last cycle the reader has seen; 0 for none.
        """
        records, lost = self.records_since(cycle)
        return [_unpack(record) for record in records], lost

    def records_since(self, cycle: int) -> tuple[list[Record], int]:
        """Return the records after `cycle`; see `read_since`.

        Args:
            cycle: Number of the last cycle the reader has seen; 0 for none.
        """
        rows = self.rows_since(cycle)
        return [rows.record(k) for k in range(len(rows))], rows.lost

    def rows_since(self, cycle: int) -> Rows:
        """Return the rows of the cycles after `cycle`; see `read_since`.

        Args:
            cycle: Number of the last cycle the reader has seen; 0 for none.
        """
        newest, capacity = self.newest, self.capacity
        first = max(cycle + 1, newest - capacity + 1)
        wanted = np.arange(first, newest + 1)
        slots = wanted % capacity
        chosen = slots.tolist()
        modes = [self.modes[slot] for slot in chosen]
        layouts = [self.layouts[slot] for slot in chosen]
        objects = [self.objects[slot] for slot in chosen]
        # The rows are copied last: an overwritten row then shows another number.
        numbers = np.asarray(self.memory).reshape(capacity, -1)[slots]
        whole = numbers[:, 0] == wanted
        if not whole.all():
            kept = np.flatnonzero(whole).tolist()
            modes, layouts = [modes[k] for k in kept], [layouts[k] for k in kept]
            objects, numbers = [objects[k] for k in kept], numbers[whole]
        lost = max(newest - cycle, 0) - len(numbers)
        return Rows(numbers, self.states, modes, layouts, objects, lost)


def _unpack(record: Record) -> Snapshot:
    cycle, epoch, stamp, period, mode, states, samples = record
    numbers = array("d", states).tolist()
    n = len(numbers) // 3
    found = {name: unpack_sample(each) for name, each in samples.items()}
    return Snapshot(
        *(cycle, epoch, stamp, period, mode),
        *(numbers[:n], numbers[n : 2 * n], numbers[2 * n :]),
        found,
    )
