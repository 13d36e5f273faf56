"""Waiting for what another thread or process does: the one place that polls."""

import time

PATIENCE = 60.0
"""How long a test waits for what must come [s].

Waiting costs nothing when it comes, and a busy machine can take ten seconds for what
takes a tenth of one on a quiet machine.
"""


def wait_until(holds, seconds=PATIENCE, pause=0.01):
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
