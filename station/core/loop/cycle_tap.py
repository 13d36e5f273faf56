"""A sample in every cycle, for as long as it has a reader."""

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

from station.core.faults import CONTAINED, describe

if TYPE_CHECKING:
    from station.core.loop.control_loop import ControlLoop

SampleT = TypeVar("SampleT")

CAPACITY = 4096
"""Samples that are kept, as many as the ring has snapshots; about 4 s at 1 kHz."""
# For those that open and close; the control thread reads the tuple as it is.
_changes = threading.Lock()


class TappedCycle(NamedTuple, Generic[SampleT]):
    """The sample of one cycle.

    Attributes:
        cycle: Number of the cycle.
        epoch: The station's epoch in that cycle.
        stamp: Station time [s].
        period: Time since the cycle before [s].
        sample: Sampled object.
    """

    cycle: int
    epoch: int
    stamp: float
    period: float
    sample: SampleT


class CycleTap(Generic[SampleT]):
    """Samples in the control thread at the end of every cycle while it is open.

    What every cycle leaves in any case is in the ring of snapshots. A tap is for what
    costs too much to be kept without a reader, such as the whole state of an arm.

    Args:
        loop: The loop.
        sample: Returns the kept values of a cycle; must not wait; no reader may change
            what it returned.

    Attributes:
        failure: Error that `sample` raised; no cycle is sampled after it. None if it
            did not raise.
    """

    def __init__(self, loop: "ControlLoop", sample: Callable[[], SampleT]) -> None:
        self.failure: str | None = None
        self._cycles = loop.control_cycle
        self._sample = sample
        self._slots: list[TappedCycle[SampleT] | None] = [None] * CAPACITY
        self._newest = self._cycles.cycle

    def open(self) -> None:
        """Sample from the next cycle on."""
        with _changes:
            self._newest = self._cycles.cycle
            self._cycles.taps = (*self._cycles.taps, self)

    def close(self) -> None:
        """Stop sampling."""
        with _changes:
            taps = self._cycles.taps
            self._cycles.taps = tuple(one for one in taps if one is not self)

    def sample_cycle(self, cycle: int, epoch: int, stamp: float, period: float) -> None:
        """Sample a cycle; control thread only."""
        # A sample that raised once would raise in every cycle and make each of them
        # late.
        if self.failure is not None:
            return
        try:
            sample = self._sample()
        except CONTAINED as error:
            self.failure = describe(error)
            return
        taken = TappedCycle(cycle, epoch, stamp, period, sample)
        self._slots[cycle % CAPACITY] = taken
        # Last: readers take what is up to here for whole.
        self._newest = cycle

    def newest_cycle(self) -> int:
        """Return the number of the last cycle that was sampled."""
        return self._newest

    def read_since(self, cycle: int) -> tuple[list[TappedCycle[SampleT]], int]:
        """Return the cycles after `cycle`, oldest first, and how many were lost.

        Args:
            cycle: Number of the last cycle the reader has seen.
        """
        newest = self._newest
        # Older ones have been overwritten.
        first = max(cycle + 1, newest - CAPACITY + 1)
        found = [
            taken
            for number in range(first, newest + 1)
            if (taken := self._slots[number % CAPACITY]) is not None
            and taken.cycle == number
        ]
        return found, max(0, newest - cycle - len(found))
