"""Estimating system time in the control thread without asking for it.

Source: realtime_tools@noetic-devel src/realtime_clock.cpp; differs: it has no thread of
its own, whoever owns it calls `measure`.
"""

KEPT = 0.9999
"""Share of the old estimate that a new measurement leaves."""


class RealtimeClock:
    """Turns the control thread's time into system time, with jitter filtered out.

    Another thread calls `measure` with the system's time from time to time. The control
    thread calls `get_system_time` every cycle; it never waits.
    """

    def __init__(self) -> None:
        self._measured: float | None = None
        self._offset: float | None = None
        self._last: float | None = None

    def measure(self, system_time: float) -> None:
        """Note the system's time [s]; any thread but the control thread."""
        self._measured = system_time

    def get_system_time(self, realtime_time: float) -> float:
        """Return the estimated system time [s]; control thread only.

        A measurement falls somewhere into the last cycle, on average into its middle,
        so half a cycle is added to it.

        Args:
            realtime_time: The control thread's time of this cycle [s].

        Returns:
            The estimate; `realtime_time` itself before the first measurement.
        """
        measured, self._measured = self._measured, None
        if measured is not None:
            last = self._last
            half = 0.0 if last is None else (realtime_time - last) / 2.0
            seen = measured + half - realtime_time
            offset = self._offset
            blended = KEPT * (offset or 0.0) + (1.0 - KEPT) * seen
            self._offset = seen if offset is None else blended
        self._last = realtime_time
        return realtime_time + (self._offset or 0.0)
