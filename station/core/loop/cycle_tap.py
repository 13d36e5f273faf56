"""Taps: samples of every cycle, taken while a reader wants them."""

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

from station.core.errors import CONTAINED, describe

if TYPE_CHECKING:
    from station.core.loop.control_loop import ControlLoop

SampleT = TypeVar("SampleT")

CAPACITY = 4096
"""Number of samples that are kept, as the ring keeps snapshots; about 4 s at 1 kHz."""
# Taken to open and to close a tap; the control thread reads the tuple without it.
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

    The ring of snapshots has the values that every cycle leaves in any case. A tap is
    for values that cost too much to be kept without a reader, such as an arm's state.

    Args:
        loop: The loop.
        sample: Returns the values of a cycle to keep; must not wait. No reader may
            change the returned object.

    Attributes:
        failure: Error that `sample` raised; no cycle is sampled after it. None without
            an error.
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
        # If `sample` raised once it would raise in every cycle, and make each one late.
        if self.failure is not None:
            return
        try:
            sample = self._sample()
        except CONTAINED as error:
            self.failure = describe(error)
            return
        taken = TappedCycle(cycle, epoch, stamp, period, sample)
        self._slots[cycle % CAPACITY] = taken
        # Set last: readers take all samples up to this cycle as complete.
        self._newest = cycle

    def newest_cycle(self) -> int:
        """Return the number of the last cycle that was sampled."""
        return self._newest

    def read_since(self, cycle: int) -> tuple[list[TappedCycle[SampleT]], int]:
        """Return the sampled cycles after `cycle`, oldest first, and the number lost.

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
