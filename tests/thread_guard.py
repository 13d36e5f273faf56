"""Find the threads that a test left behind."""

import threading
import time
from collections.abc import Iterable

from tests.waiting import PATIENCE

POOL = "AnyIO worker thread"
"""These end with their event loop, whose own thread is looked at here."""
GRACE = PATIENCE
"""How long a stopped thread may take to end [s]; passing tests do not wait."""


def leaked_threads(
    before: Iterable[threading.Thread], *, grace: float = GRACE
) -> list[threading.Thread]:
    """Return the threads that were not there before and do not end by themselves.

    Args:
        before: The threads that ran when the test began.
        grace: How long to wait for all of them together [s], >= 0.

    Returns:
        New threads, daemons too, that still run; empty if the test cleaned up.
    """
    known = set(before)
    deadline = time.monotonic() + grace
    new = [
        thread
        for thread in threading.enumerate()
        if thread not in known and thread.name != POOL
    ]
    for thread in new:
        if thread is not threading.current_thread():
            thread.join(max(0.0, deadline - time.monotonic()))
    return [thread for thread in new if thread.is_alive()]
