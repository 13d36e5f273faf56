"""Samples of every cycle in batches, from the ring of snapshots or from a tap."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, TypeVar

from typing_extensions import override

from station.core.facade.station import Station
from station.core.loop.cycle_tap import CycleTap, TappedCycle
from station.core.loop.snapshot import Snapshot

Data = dict[str, object]
SampleT = TypeVar("SampleT")

BATCH_LIMIT = 250
"""Most cycles in one batch, because encoding it must not hold the interpreter for long.
"""


class Payload(NamedTuple):
    """Content of a frame, before it is encoded.

    Attributes:
        cycle: Cycle of the data.
        epoch: Epoch of the data.
        stamp: Station time of the data [s].
        data: The topic's fields.
    """

    cycle: int
    epoch: int
    stamp: float
    data: Data


class CycleSamples(ABC):
    """The samples of one topic.

    Args:
        station: The station.
        head: Returns the fields of a batch besides its samples.
        limit: Most cycles in one batch.
    """

    def __init__(
        self,
        station: Station,
        head: Callable[[], Data] = dict,
        limit: int = BATCH_LIMIT,
    ) -> None:
        self._station = station
        self._head = head
        self._limit = limit

    def open(self) -> None:
        """Begin to sample; do nothing by default, as for the ring of snapshots."""
        return

    def close(self) -> None:
        """End the sampling that `open` began."""
        return

    @abstractmethod
    def newest_cycle(self) -> int:
        """Return the number of the last cycle; 0 before the first one."""

    @abstractmethod
    def since(self, cycle: int, newest: int) -> Payload | None:
        """Return the samples after `cycle` as one batch; None if there are none.

        In the batch, `lost` is the number of cycles whose samples were overwritten
        before they were read, and `skipped` the number of deadlines for which the loop
        made no cycle.

        Args:
            cycle: Last cycle that the client has.
            newest: Largest number of the batch's last cycle.
        """

    def _batch(
        self,
        read: Sequence[Snapshot] | Sequence[TappedCycle[SampleT]],
        samples: list[Data],
        lost: int,
    ) -> Payload:
        period = self._station.loop.period
        skipped = sum(max(0, round(one.period / period) - 1) for one in read)
        last = read[-1]
        head = self._head()
        data = {**head, "samples": samples, "lost": lost, "skipped": skipped}
        return Payload(last.cycle, last.epoch, last.stamp, data)


class RingSamples(CycleSamples):
    """Samples of the snapshots in the ring.

    Args:
        station: The station.
        sample: Returns the fields of a cycle; None if the cycle has none.
        head: Returns the fields of a batch besides its samples.
    """

    def __init__(
        self,
        station: Station,
        sample: Callable[[Snapshot], Data | None],
        head: Callable[[], Data] = dict,
    ) -> None:
        super().__init__(station, head)
        self._sample = sample

    @override
    def newest_cycle(self) -> int:
        snapshot = self._station.snapshots.latest()
        return 0 if snapshot is None else snapshot.cycle

    @override
    def since(self, cycle: int, newest: int) -> Payload | None:
        snapshots, lost = self._station.snapshots.read_since(cycle)
        # Stop at the cycle of this tick, so that clients that keep up share one batch.
        snapshots = snapshots[: min(self._limit, newest - cycle)]
        if not snapshots:
            return None
        samples = [
            {"cycle": snapshot.cycle, **data}
            for snapshot in snapshots
            if (data := self._sample(snapshot)) is not None
        ]
        return self._batch(snapshots, samples, lost)


class TapSamples(CycleSamples, Generic[SampleT]):
    """Samples that the control thread takes while a client reads them.

    Args:
        station: The station.
        take: Returns the values of a cycle to keep; called by the control thread.
        show: Returns the fields of a sample from the kept values.
        head: Returns the fields of a batch besides its samples.
        limit: Most cycles in one batch.
    """

    def __init__(
        self,
        station: Station,
        take: Callable[[], SampleT],
        show: Callable[[SampleT], Data],
        head: Callable[[], Data] = dict,
        limit: int = BATCH_LIMIT,
    ) -> None:
        super().__init__(station, head, limit)
        self._tap: CycleTap[SampleT] = CycleTap(station.loop, take)
        self._show = show

    @override
    def open(self) -> None:
        self._tap.open()

    @override
    def close(self) -> None:
        self._tap.close()

    @override
    def newest_cycle(self) -> int:
        """Return the number of the last sampled cycle.

        Raises:
            RuntimeError: The control thread could not take a sample.
        """
        if self._tap.failure is not None:
            raise RuntimeError(f"A cycle cannot be sampled: {self._tap.failure}.")
        return self._tap.newest_cycle()

    @override
    def since(self, cycle: int, newest: int) -> Payload | None:
        taken, lost = self._tap.read_since(cycle)
        taken = taken[: min(self._limit, newest - cycle)]
        if not taken:
            return None
        samples: list[Data] = [
            {"cycle": one.cycle, "stamp": one.stamp, **self._show(one.sample)}
            for one in taken
        ]
        return self._batch(taken, samples, lost)
