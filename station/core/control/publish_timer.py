"""When a controller that publishes at a rate is due."""


class PublishTimer:
    """Says in which cycles to publish. It reads no clock: it is told the time.

    Args:
        rate: How often to publish [Hz]; never when it is not positive.
    """

    def __init__(self, rate: float) -> None:
        self._interval = 1.0 / rate if rate > 0.0 else 0.0
        self._last: float | None = None

    def start(self, time: float, *, at_once: bool) -> None:
        """Begin the rhythm; a rhythm that has begun goes on.

        Args:
            time: Station time [s].
            at_once: Whether the next cycle is due already.
        """
        if self._last is None:
            self._last = time - 1.001 * self._interval if at_once else time

    def is_due(self, time: float) -> bool:
        """Say, once per publication, whether it is time; missed ones are left out.

        Args:
            time: Station time [s].
        """
        if self._interval == 0.0 or self._last is None:
            return False
        due = self._last + self._interval
        if due >= time:
            return False
        self._last = due if time - due < self._interval else time
        return True
