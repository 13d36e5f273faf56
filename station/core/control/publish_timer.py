"""Decide in which cycles a controller publishes."""

from station.core.declared_parameter import DeclaredParameter, ParameterType

PUBLISH_RATE = DeclaredParameter(
    name="publish_rate",
    type=ParameterType.NUMBER,
    unit="Hz",
    description="rate of publication; 0: nothing is published",
)


class PublishTimer:
    """Decides in which cycles to publish, from the station time it is given.

    Args:
        rate: Rate of publication [Hz]; when it is not positive, nothing is published.
    """

    def __init__(self, rate: float) -> None:
        self._interval = 1.0 / rate if rate > 0.0 else 0.0
        self._last: float | None = None

    def start(self, time: float, *, at_once: bool) -> None:
        """Start to count; a timer that was started before is not changed.

        Args:
            time: Station time [s].
            at_once: Whether a publication is due in the next cycle already.
        """
        if self._last is None:
            self._last = time - 1.001 * self._interval if at_once else time

    def is_due(self, time: float) -> bool:
        """Return whether a publication is due, once per publication.

        Publications that were missed are left out.

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
