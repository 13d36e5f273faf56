"""The monotonic clock of the operating system, the same in both modes."""

import cython

if cython.compiled:
    from cython.cimports.posix.time import CLOCK_MONOTONIC, clock_gettime, timespec
else:
    from time import perf_counter


def wall_time() -> float:
    """Return monotonic time [s]; its origin has no meaning."""
    if cython.compiled:
        now: timespec = timespec()
        clock_gettime(CLOCK_MONOTONIC, cython.address(now))
        return now.tv_sec + 1e-9 * now.tv_nsec
    return perf_counter()
