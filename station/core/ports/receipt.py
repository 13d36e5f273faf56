"""The cycle that picked a command up, and further facts for a re-run."""

import threading
from collections.abc import Callable


class _Thread(threading.local):
    """The cycle in which the update of this thread began; None in the control thread.

    An asynchronous update goes on in later cycles, but whatever it reads counts from
    the cycle in which it began: there a re-run carries it out as a whole.
    """

    cycle: int | None = None


update_of_thread = _Thread()


class Receipt:
    """Goes with a command, and is noted on by the control thread.

    Args:
        present_cycle: Returns the number of the present cycle.

    Attributes:
        cycle: The cycle whose update was the first with the command; None while none
            has picked it up, which stays so when a newer command came before.
        done: Released once `cycle` is there.
        ended: The cycle in which a set-point expired; None while it has not.
        planned_at: Station time of the cycle whose state a trajectory was planned from
            [s]; None for commands without a plan.
        held: List of commands that a re-run hands over later; None hands them over
            at once.
    """

    def __init__(self, present_cycle: Callable[[], int]) -> None:
        self.cycle: int | None = None
        self._present_cycle = present_cycle
        # Released by the control thread, which never waits for it.
        self.done = threading.Lock()
        self.done.acquire()
        self.ended: int | None = None
        self.planned_at: float | None = None
        self.held: list[Callable[[], None]] | None = None

    def pick_up(self) -> None:
        """Note the present cycle; in an update or the control thread."""
        if self.cycle is None:
            self.cycle = self._cycle_of_update()
            self.done.release()

    def end(self) -> None:
        """Note that the set-point expires now; in an update or the control thread."""
        self.ended = self._cycle_of_update()

    def _cycle_of_update(self) -> int:
        began = update_of_thread.cycle
        return self._present_cycle() if began is None else began

    def hand_over(self, deposit: Callable[[], None]) -> None:
        """Call `deposit`, which gives the command to the control thread.

        A re-run lets it wait for the cycle that the recording names.
        """
        if self.held is None:
            deposit()
        else:
            self.held.append(deposit)
