"""A clock for a loop in its thread: no cycle waits, and callers wait for cycles."""

from typing_extensions import override

from station.core.clock import ManualClock


class PatientClock(ManualClock):
    """A clock that jumps for the loop, while callers wait for it to answer."""

    @override
    def wait_for(self, lock, deadline):
        return lock.acquire(timeout=5.0)
