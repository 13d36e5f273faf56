"""Tickets of commands: the cycle that accepted a command, and facts for a re-run.

A re-run repeats recorded cycles with the same commands in the same cycles.
"""

import threading
from collections.abc import Callable


class _Thread(threading.local):
    """The cycle in which the update of this thread began; None in the control thread.

    An asynchronous update goes on in later cycles, but counts as part of the cycle in
    which it began: a re-run carries out the whole update in that cycle.
    """

    cycle: int | None = None


update_of_thread = _Thread()


class CommandTicket:
    """A note that goes with a command; the control thread writes on it.

    Args:
        present_cycle: Returns the number of the present cycle.

    Attributes:
        accepted_cycle: The first cycle whose update used the command; None before
            that, and for ever if a newer command replaced it first.
        done: A lock that is released once `accepted_cycle` is known.
        ended: The cycle in which a set-point expired; None before that.
        planned_at: Station time of the cycle whose state a trajectory was planned from
            [s]; None for commands without a plan.
        held: Commands that a re-run keeps until their cycle; None hands each command
            over at once.
    """

    def __init__(self, present_cycle: Callable[[], int]) -> None:
        self.accepted_cycle: int | None = None
        self._present_cycle = present_cycle
        # Released by the control thread, which never waits for it.
        self.done = threading.Lock()
        self.done.acquire()
        self.ended: int | None = None
        self.planned_at: float | None = None
        self.held: list[Callable[[], None]] | None = None

    def accept(self) -> None:
        """Note the present cycle; called in an update or in the control thread."""
        if self.accepted_cycle is None:
            self.accepted_cycle = self._cycle_of_update()
            self.done.release()

    def end(self) -> None:
        """Note that the set-point expires in this cycle; called as `accept`."""
        self.ended = self._cycle_of_update()

    def _cycle_of_update(self) -> int:
        began = update_of_thread.cycle
        return self._present_cycle() if began is None else began

    def hand_over(self, deposit: Callable[[], None]) -> None:
        """Call `deposit`, which gives the command to the control thread.

        A re-run keeps the command until the cycle that the recording names.
        """
        if self.held is None:
            deposit()
        else:
            self.held.append(deposit)
