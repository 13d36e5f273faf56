"""Something that is done again and again beside a plain program."""

import threading
from collections.abc import Callable

from station.client.errors import ApiError, StationUnreachableError


class Heartbeat:
    """Beats in a thread until it is stopped, or until the station refuses.

    Args:
        beat: What is done.
        period: Time between two beats [s], > 0.

    Attributes:
        refusal: Why the station refused, which ended the heartbeat; None otherwise.
    """

    def __init__(self, beat: Callable[[], object], period: float) -> None:
        self._beat = beat
        self._period = period
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name="heartbeat", daemon=True)
        self.refusal: ApiError | None = None

    def start(self) -> None:
        """Begin; the first beat comes after a period."""
        self._thread.start()

    def stop(self) -> None:
        """End, after a beat that is under way."""
        self._end.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._end.wait(self._period):
            try:
                self._beat()
            except StationUnreachableError:
                continue  # the link may come back before the lease is over
            except ApiError as error:
                self.refusal = error
                return
