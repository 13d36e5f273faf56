"""A clock for a loop in its thread: no cycle waits, and callers wait for cycles."""

import time

from typing_extensions import override

from station.core.clock import ManualClock
from tests.waiting import PATIENCE


class PatientClock(ManualClock):
    """A clock that jumps for the loop, while callers wait for it to answer.

    A loop that never waits would keep the interpreter for itself: between two cycles it
    lets the other threads run.
    """

    @override
    def sleep_until(self, deadline):
        super().sleep_until(deadline)
        time.sleep(1e-4)

    @override
    def wait_for(self, lock, deadline):
        return lock.acquire(timeout=PATIENCE)
