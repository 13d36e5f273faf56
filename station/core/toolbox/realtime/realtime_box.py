"""One value that any thread may set and get.

Source: realtime_tools@noetic-devel realtime_box.h; differs: a reference is swapped, so
that nobody locks and nobody waits.
"""

from typing import Generic, TypeVar

T = TypeVar("T")


class RealtimeBox(Generic[T]):
    """Holds the newest value. All methods for any thread, none ever waits.

    What is in the box belongs to all who look into it: put in a value that nobody
    changes afterwards, such as a tuple or a frozen dataclass.

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
