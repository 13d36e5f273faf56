"""Estimate the system's time in the control thread without a system call.

Source: realtime_tools@noetic-devel src/realtime_clock.cpp; differs: the clock has no
thread of its own; its owner calls `measure`.
"""

KEPT = 0.9999
"""Weight of the old estimate when a new measurement arrives, 0 to 1."""


class RealtimeClock:
    """Convert the control thread's time into system time, with jitter filtered out.

    Another thread calls `measure` with the system's time now and then. The control
    thread calls `get_system_time` in every cycle and never waits.
    """

    def __init__(self) -> None:
        self._measured: float | None = None
        self._offset: float | None = None
        self._last: float | None = None

    def measure(self, system_time: float) -> None:
        """Record the system's time [s]; any thread but the control thread."""
        self._measured = system_time

    def get_system_time(self, realtime_time: float) -> float:
        """Return the estimated system time [s]; control thread only.

        A measurement was taken at some time in the last cycle, on average in its
        middle, so half a cycle is added to it.

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
