"""Let the station refuse a change that it would only begin long after it was sent.

A station that hangs has what was sent to it in the memory of its socket, and carries it
out when it goes on: the sender may have gone away meanwhile.
"""

import time
from collections.abc import Callable, Mapping

CLOCK_HEADER = "X-Station-Clock"
"""Header of every answer: the station's wall time [s since 1970]."""
NOT_AFTER_HEADER = "X-Not-After"
"""Header of a change: the latest time by that clock at which it may begin."""

_ANSWERS = 20


class Promptness:
    """Says by the station's own clock until when a change may begin. Any thread.

    The clocks of two machines may differ: what is added to is the station's time in its
    answers, and the time that has passed here since. An answer that was read late tells
    too early a time, so that the latest of what the last answers tell counts.

    Args:
        within: How long after it was sent a change may begin [s], > 0.
        now: Monotonic clock [s].
    """

    def __init__(
        self, within: float, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._within = within
        self._now = now
        self._ahead: tuple[float, ...] = ()

    def hear(self, headers: Mapping[str, str]) -> None:
        """Note the station's time in the headers of an answer, if it is there."""
        told = headers.get(CLOCK_HEADER)
        if told is not None:
            self._ahead = (*self._ahead[1 - _ANSWERS :], float(told) - self._now())

    def headers(self) -> dict[str, str]:
        """Return the header of a change that is sent now; none before an answer."""
        if not self._ahead:
            return {}
        not_after = self._now() + max(self._ahead) + self._within
        return {NOT_AFTER_HEADER: f"{not_after:.3f}"}
