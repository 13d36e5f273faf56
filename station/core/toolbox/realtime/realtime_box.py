"""One value that any thread may set and get.

Source: realtime_tools@noetic-devel realtime_box.h; differs: a reference is swapped, so
that nobody locks and nobody waits.
"""

from typing import Generic, TypeVar

T = TypeVar("T")


class RealtimeBox(Generic[T]):
    """Hold the newest value. Any thread may call the methods; none of them waits.

    All readers share the value, so it must not be changed after `set`: use a tuple or a
    frozen dataclass.

    Args:
        initial: The first value.
    """

    def __init__(self, initial: T) -> None:
        self._value = initial

    def set(self, value: T) -> None:
        """Replace the value."""
        self._value = value

    def get(self) -> T:
        """Return the newest value."""
        return self._value
