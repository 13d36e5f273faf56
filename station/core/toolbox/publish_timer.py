"""Decide in which cycles a controller publishes."""

_NEVER = float("-inf")


class PublishTimer:
    """Decides from the station time in which cycles to publish.

    Args:
        rate: Rate of publication [Hz]; when it is not positive, nothing is published.
    """

    def __init__(self, rate: float) -> None:
        self.interval = 1.0 / rate if rate > 0.0 else 0.0
        self.last = _NEVER

    def start(self, time: float, at_once: bool) -> None:  # noqa: FBT001 - for the compiler
        """Start to count; a timer that was started before does not change.

        Args:
            time: Station time [s].
            at_once: Whether the first publication is already due in the next cycle.
        """
        if self.last == _NEVER:
            self.last = time - 1.001 * self.interval if at_once else time

    def is_due(self, time: float) -> bool:
        """Return whether a publication is due; True once for each publication.

        Missed publications are left out.

        Args:
            time: Station time [s].
        """
        due = self.last + self.interval
        if self.last == _NEVER or self.interval == 0.0 or due >= time:
            return False
        self.last = due if time - due < self.interval else time
        return True
