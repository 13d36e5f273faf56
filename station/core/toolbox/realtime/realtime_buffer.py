"""A value that others write and the control thread reads.

Source: realtime_tools@noetic-devel realtime_buffer.h; differs: a reference is swapped
instead of two buffers under a lock, so the control thread always gets the newest.
"""

from typing import Generic, TypeVar

T = TypeVar("T")


class RealtimeBuffer(Generic[T]):
    """Hand the newest value to the control thread, and know whether it is new.

    Values must not be changed after they were written.

    Args:
        initial: The first value; it does not count as new.
    """

    def __init__(self, initial: T) -> None:
        self._newest = initial
        self._seen = initial

    def write_from_non_rt(self, value: T) -> None:
        """Replace the value; any thread but the control thread."""
        self._newest = value

    def read_from_non_rt(self) -> T:
        """Return the newest value; any thread but the control thread."""
        return self._newest

    def read_from_rt(self) -> T:
        """Return the newest value; control thread only, never waits."""
        self._seen = self._newest
        return self._seen

    def has_new(self) -> bool:
        """Return whether a value was written since `read_from_rt`; control thread."""
        return self._newest is not self._seen

    def init_rt(self, value: T) -> None:
        """Set a value that does not count as new; control thread, as in `starting`."""
        self._newest = self._seen = value
