"""The limit on restarts of a process that ends by itself."""

import time

MOST_RESTARTS = 3
"""Number of restarts of a process within `MEMORY`."""
MEMORY = 60.0
"""Time for which an end of the process counts [s]."""


class RestartLimit:
    """Allows restarts of a process, unless it ends again and again."""

    def __init__(self) -> None:
        self._ends: list[float] = []

    def allows_another(self) -> bool:
        """Note that the process has ended; return whether to start it again."""
        now = time.monotonic()
        self._ends = [*(end for end in self._ends if now - end < MEMORY), now]
        return len(self._ends) <= MOST_RESTARTS
