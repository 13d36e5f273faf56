"""Find incidents in the cycles: stops, reflexes, bursts of overruns, faults."""

from collections import deque

from station.core.facade.station import Station
from station.records.cycle_messages import Row, RowForm

REFLEX_MODES = frozenset({"reflex", "user_stopped"})
BURST = 5
"""Number of deadlines skipped within `BURST_WINDOW` that make a burst of overruns."""
BURST_WINDOW = 0.1
"""[s station time]"""
BURST_PAUSE = 60.0
"""Time after a burst before another one counts [s station time]: a machine that is busy
for hours must not push every other incident out of the folder."""


class IncidentWatch:
    """Looks at every cycle; recorder thread only.

    Args:
        station: The station.
    """

    def __init__(self, station: Station) -> None:
        self._station = station
        self._period = station.loop.period
        self._stop_cycle = station.loop.stop_latch.cycle
        self._form: RowForm | None = None
        self._mode: str | None = None
        self._running: frozenset[str] = frozenset()
        self._skips: deque[float] = deque(maxlen=BURST)
        self._last_burst = -BURST_PAUSE

    def look(self, row: Row) -> list[str]:
        """Return the incidents of a cycle, one sentence each."""
        causes = []
        # The form has mode and controllers, so a usual cycle needs no comparison of
        # them.
        if row.form is not self._form:
            self._form = row.form
            causes += self._look_at_form(row.form)
        # The threshold lies between one period and two, so that rounding does not count
        # as a skipped deadline.
        if row.period > 1.5 * self._period:
            causes += self._skipped(row)
        return causes

    def _look_at_form(self, form: RowForm) -> list[str]:
        causes = []
        if form.mode != self._mode:
            # A recording that begins during a reflex is no incident.
            if form.mode in REFLEX_MODES and self._mode is not None:
                causes.append(f"The robot went from {self._mode} to {form.mode}.")
            self._mode = form.mode
        running = frozenset(one.name for one in form.samples)
        causes += self._faults(self._running - running)
        self._running = running
        return causes

    def look_at_stop(self) -> list[str]:
        """Return the reason for a stop since the last call; once per batch."""
        latch = self._station.loop.stop_latch
        # The cycle that carried a stop out identifies the stop.
        if latch.cycle == self._stop_cycle:
            return []
        self._stop_cycle = latch.cycle
        return [f"The station was stopped: {latch.reason or 'no reason given'}."]

    def _faults(self, gone: frozenset[str]) -> list[str]:
        if not gone:
            return []
        return [
            f"Controller '{one.name}' was stopped: {one.fault.rstrip('.')}."
            for one in self._station.controllers()
            if one.name in gone and one.fault
        ]

    def _skipped(self, row: Row) -> list[str]:
        count = round(row.period / self._period) - 1
        # Add no more entries than the deque holds, however long the gap.
        self._skips.extend([row.time] * min(count, BURST))
        if len(self._skips) < BURST or row.time - self._skips[0] > BURST_WINDOW:
            return []
        # The same deadlines must not count for a second burst.
        self._skips.clear()
        if row.time - self._last_burst < BURST_PAUSE:
            return []
        self._last_burst = row.time
        window = 1000.0 * BURST_WINDOW
        return [f"The loop skipped {BURST} or more deadlines in {window:g} ms."]
