"""The right of way of the control thread: others wait for a cycle that is due.

A thread that computes keeps the interpreter lock until another thread has waited for a
switch interval, 0.1 ms and more. Frequent work that takes less than that would make one
cycle in ten late. So such work is done in short pieces, and each piece waits first if
the next cycle would begin during it (benchmarks/bench_jitter.py).
"""

from station.core.clock import Clock
from station.core.loop.heartbeat import Heartbeat
from station.core.loop.simulation_speed import SimulationSpeed

PIECE = 4e-4
"""Longest piece of work [s]; longer work asks again in between. Most pieces take 0.05
ms, but more when the interpreter changes hands or the machine hesitates: with 0.18 ms
here, one cycle in fifty still found the interpreter taken."""
HEAD_START = 1.5e-4
"""Time after the beginning of a cycle at which other threads continue [s]."""
OVERDUE = 5e-4
"""Lateness beyond which other threads no longer wait for a cycle [s]."""

_LONGEST_WAIT = 0.02
"""Time until the next cycle beyond which other threads do not wait for it [s]."""


class CycleYield:
    """Tells other threads when to wait for the control thread, which never calls it.

    Args:
        clock: The loop's clock.
        heartbeat: Page that has the time of every wake-up of the control thread.
        period: The loop's nominal period [s].
        speed: How fast station time passes.
    """

    def __init__(
        self, clock: Clock, heartbeat: Heartbeat, period: float, speed: SimulationSpeed
    ) -> None:
        self._clock = clock
        self._beats = heartbeat.beats
        self._period = period
        self._speed = speed

    def wait_if_cycle_is_due(self) -> None:
        """Wait until a cycle that is about to begin has begun; else return at once.

        It waits about 0.6 ms at most, and not at all for a loop that hangs or has
        ended, or whose cycles leave no time to compute in between.
        """
        wall_period = self._period / self._speed.real_time_factor
        begins = self._beats[0] + wall_period
        now = self._clock.now()
        # In a fast loop a wait would leave no time to work in, so no thread waits.
        if -OVERDUE < begins - now < PIECE < 0.5 * wall_period:
            # A little beyond the deadline: the control thread needs a moment to wake up
            # and take the interpreter.
            self._clock.sleep_until(max(begins, now) + HEAD_START)

    def wait_for_begun_cycle(self) -> None:
        """Wait until the next cycle has begun, so that its period is still to come.

        Work that takes most of a period begins after this call, so that it delays the
        cycle after it as little as possible.
        """
        begins = self._beats[0] + self._period / self._speed.real_time_factor
        if begins - self._clock.now() < _LONGEST_WAIT:
            self._clock.sleep_until(begins + HEAD_START)
