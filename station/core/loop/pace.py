"""Whether station time passes, and how fast."""


class Pace:
    """The pace of a loop's thread. Changed between two cycles.

    Args:
        real_time_factor: Station time over wall time, > 0.

    Attributes:
        real_time_factor: The same.
        paused: Time stands still, but for the steps asked for.
        steps_due: Cycles still to be run while paused.
    """

    def __init__(self, real_time_factor: float = 1.0) -> None:
        self.real_time_factor = real_time_factor
        self.paused = False
        self.steps_due = 0

    def passes(self) -> bool:
        """Tell whether the cycle that is due is to be run; counts a step down."""
        if not self.paused:
            return True
        if self.steps_due == 0:
            return False
        self.steps_due -= 1
        return True

    def resume(self) -> None:
        """Let time pass; steps that were asked for are part of it."""
        self.paused = False
        self.steps_due = 0
