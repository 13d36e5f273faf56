"""The control thread has the right of way: others look before they compute.

A thread that computes keeps the interpreter lock until another has waited for it for a
switch interval, 0.1 ms and more. Work that comes often and takes less than that would
make one cycle in ten late. So it is done in short pieces, and each piece waits when the
next cycle would begin meanwhile (benchmarks/bench_jitter.py).
"""

from station.core.clock import Clock
from station.core.loop.heartbeat import Heartbeat
from station.core.loop.pace import Pace

PIECE = 4e-4
"""How long a piece of work may take [s]; what is longer looks again in between.
Most take 0.05 ms, but more when the interpreter changes hands or the machine hesitates:
with 0.18 ms here, one cycle in fifty still found the interpreter taken."""
HEAD_START = 1.5e-4
"""How long after the beginning of a cycle the others come back [s]."""
OVERDUE = 5e-4
"""A cycle that is late by more than this is waited for no longer [s]."""

_LONGEST_WAIT = 0.02
"""A cycle that begins later than this is not waited for [s]."""


class RightOfWay:
    """Tells other threads when to wait for the control thread. Any thread but that one.

    Args:
        clock: The loop's clock.
        heartbeat: Page that has the time of every wake-up of the control thread.
        period: The loop's nominal period [s].
        pace: How fast its time passes.
    """

    def __init__(
        self, clock: Clock, heartbeat: Heartbeat, period: float, pace: Pace
    ) -> None:
        self._clock = clock
        self._beats = heartbeat.beats
        self._period = period
        self._pace = pace

    def give(self) -> None:
        """Wait until a cycle that is about to begin has begun; else return at once.

        Never longer than about 0.6 ms, and not for a loop that hangs or has ended, nor
        for one whose cycles follow each other too closely to compute in between.
        """
        wall_period = self._period / self._pace.real_time_factor
        begins = self._beats[0] + wall_period
        now = self._clock.now()
        # With a fast loop there would be no time left to work in, so nobody waits.
        if -OVERDUE < begins - now < PIECE < 0.5 * wall_period:
            # Until the cycle has the interpreter: it needs a moment to wake up and take
            # it.
            self._clock.sleep_until(max(begins, now) + HEAD_START)

    def wait_for_begun_cycle(self) -> None:
        """Wait until the next cycle has begun, so that its period is still to come.

        For work that takes most of a period, at any moment: it then makes the next
        cycle as little late as possible.
        """
        begins = self._beats[0] + self._period / self._pace.real_time_factor
        if begins - self._clock.now() < _LONGEST_WAIT:
            self._clock.sleep_until(begins + HEAD_START)
