"""A robot whose states come at a pace of its own."""

from typing import Protocol


class RobotClock(Protocol):
    """Paces a control thread in the place of the wall clock. Control thread only.

    A real arm has a clock, and a loop with another clock would see some of its states
    twice or never. So the loop waits for the arm.
    """

    def wait(self) -> int:
        """Wait for the robot's next state, some milliseconds at most.

        Returns:
            How many of its cycles have passed since the last call: usually 1, 0 if no
            state came. A robot that is lost lets time pass, so that the cycles go on.
        """
