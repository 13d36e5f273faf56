"""Waiting for what another thread or process does: the one place that polls."""

import time


def wait_until(holds, seconds=20.0, pause=0.01):
    """Poll until `holds()` is true; return its last answer, which callers assert.

    Args:
        holds: What is waited for.
        seconds: How long at most [s].
        pause: Time between two looks [s].
    """
    deadline = time.monotonic() + seconds
    while not (answer := holds()) and time.monotonic() < deadline:
        time.sleep(pause)
    return answer
