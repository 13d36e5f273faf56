"""Whether a control thread has to look at a set-point before it goes on with it."""

from collections.abc import Sized

_INF = float("inf")


class SetPointNews:
    """What a control thread has to look at before it goes on with a set-point.

    Args:
        slot: Holds the set-point that waits; empty when none does.

    Attributes:
        is_void: Whether the set-points were made void.
        deadline: When the set-point in force expires [s]; infinite when it does not.
    """

    def __init__(self, slot: Sized) -> None:
        self.slot = slot
        self.is_void = False
        self.deadline = _INF

    def is_possible(self) -> bool:
        """Return whether there may be news."""
        return len(self.slot) > 0 or self.is_void or self.deadline != _INF
