"""In which cycle a command was picked up."""

import threading
from collections.abc import Callable


class Receipt:
    """Goes with a command, and is noted on by the control thread.

    Args:
        present_cycle: Returns the number of the present cycle.

    Attributes:
        cycle: The cycle whose update was the first with the command; None while none
            has picked it up, which stays so when a newer command came before.
        done: Released once `cycle` is there.
    """

    def __init__(self, present_cycle: Callable[[], int]) -> None:
        self.cycle: int | None = None
        self._present_cycle = present_cycle
        # Released by the control thread, which never waits for it.
        self.done = threading.Lock()
        self.done.acquire()

    def pick_up(self) -> None:
        """Note the present cycle; control thread only."""
        if self.cycle is None:
            self.cycle = self._present_cycle()
            self.done.release()
