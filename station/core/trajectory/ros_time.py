"""Times of trajectories in whole nanoseconds, so that sums of times compare exactly.

Source: rostime include/ros/time.h, duration.h.
"""

_PER_SECOND = 1_000_000_000
_LARGE = 1 << 62


def to_nanoseconds(seconds: float) -> int:
    """Return the whole nanoseconds nearest to a time [s]."""
    whole = int(seconds // 1.0)
    return whole * 1_000_000_000 + round((seconds - whole) * 1e9)


def to_seconds(nanoseconds: int) -> float:
    """Return a time [s] exactly as the original converts seconds and nanoseconds."""
    if -_LARGE < nanoseconds < _LARGE:
        return uptime_seconds(nanoseconds)
    seconds, rest = divmod(nanoseconds, 1_000_000_000)  # too large for a number of C
    return seconds + 1e-9 * rest


def uptime_seconds(nanoseconds: int) -> float:
    """Return a time of less than 100 years [s], converted as by `to_seconds`."""
    seconds = nanoseconds // _PER_SECOND
    rest = nanoseconds - seconds * _PER_SECOND
    # A division in C rounds towards zero.
    if rest < 0:
        seconds -= 1
        rest += _PER_SECOND
    return seconds + 1e-9 * rest
