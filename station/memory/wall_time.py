"""Wall time: the operating system's, and a virtual one that only code advances."""

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
    wall_time = perf_counter  # the same without a call in Python around it


class VirtualTime:
    """Wall time that passes only when code changes it.

    Args:
        seconds: First value [s].

    Attributes:
        seconds: The present time [s].
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
