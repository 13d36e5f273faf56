"""The state of the control loop: measured each cycle, summarised on demand."""

import numpy as np

from station.core.clock import Clock
from station.core.numerics.durations import CycleTimes
from station.core.numerics.statistics import DurationRing, percentiles_of
from station.reports import LoopReport, LoopState


class LoopMeter:
    """Takes the times of a cycle; no allocation. The control thread measures.

    Args:
        clock: Wall time.

    Attributes:
        times: Takes the durations of every cycle.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._lateness = DurationRing()
        self.times = CycleTimes()
        self._since = self.times.last = clock.now()
        self._skipped = 0
        self._skipped_before = 0

    @property
    def total_skipped(self) -> int:
        """Number of deadlines ever skipped; a reset does not change it."""
        return self._skipped

    def reset(self) -> None:
        """Start anew."""
        self._lateness.reset()
        self.times.reset()
        self._since = self.times.last = self._clock.now()
        # The total goes on: others count with it.
        self._skipped_before = self._skipped

    def woke(self, lateness: float, skipped: int) -> None:
        """Note how late the thread woke [s] and how many deadlines had passed."""
        self._lateness.add(lateness)
        self._skipped += skipped

    def idled(self) -> None:
        """Note that the thread woke while time stands still: it counts for nothing."""
        now = self._clock.now()
        # Time in a pause must not lower the achieved rate.
        self._since += now - self.times.last
        self.times.last = now

    def report(
        self,
        *,
        state: LoopState,
        failure: str,
        period: float,
        real_time_factor: float,
        scheduler: str,
    ) -> LoopReport:
        """Summarise the cycles since the last reset. Any thread.

        Args:
            state: Whether the thread runs.
            failure: Traceback of what ended it; empty if nothing did.
            period: Nominal period in station time [s], > 0.
            real_time_factor: Station time over wall time, as asked for, > 0.
            scheduler: Scheduling class granted to the thread, in words.
        """
        times = self.times
        elapsed = times.last - self._since
        cycles, skipped = times.count, self._skipped - self._skipped_before
        parts = np.asarray(times.rows).reshape(-1, 4)[:cycles].T.copy()
        rate = real_time_factor / period
        achieved = cycles / elapsed if elapsed > 0.0 else 0.0
        simulated = (cycles + skipped) * period
        return LoopReport(
            state=state,
            failure=failure,
            rate=rate,
            achieved_rate=achieved,
            period=period,
            cycles=cycles,
            skipped=skipped,
            real_time_factor=real_time_factor,
            achieved_real_time_factor=simulated / elapsed if elapsed > 0.0 else 0.0,
            lateness=self._lateness.percentiles(),
            read=percentiles_of(parts[0], times.longest_read, cycles),
            update=percentiles_of(parts[1], times.longest_update, cycles),
            write=percentiles_of(parts[2], times.longest_write, cycles),
            total=percentiles_of(parts[3], times.longest_total, cycles),
            scheduler=scheduler,
        )
