"""Wall time: that of the operating system, and one that stands still in between."""

from time import perf_counter

import cython

if cython.compiled:
    from cython.cimports.posix.time import CLOCK_MONOTONIC, clock_gettime, timespec


def wall_time() -> float:
    """Return monotonic time [s]; its origin has no meaning."""
    if cython.compiled:
        now: timespec = timespec()
        clock_gettime(CLOCK_MONOTONIC, cython.address(now))
        return now.tv_sec + 1e-9 * now.tv_nsec
    return perf_counter()


if not cython.compiled:
    wall_time = perf_counter  # the same without a call of Python around it


class VirtualTime:
    """Wall time that passes on demand.

    Args:
        seconds: Its first value [s].

    Attributes:
        seconds: The present time [s].
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
