"""Speed of station time, and its pause."""

from station.core.errors import ParameterError

SLOWEST = 0.01
"""Smallest real-time factor; a cycle of 1 ms then takes 0.1 s of wall time."""
FASTEST = 100.0
"""Largest real-time factor."""


class SimulationSpeed:
    """The speed of station time in a loop's thread. Changed between two cycles.

    Args:
        real_time_factor: Station time over wall time, `SLOWEST` to `FASTEST`.

    Attributes:
        real_time_factor: Station time over wall time.
        paused: Whether time stands still, except for requested steps.
        steps_due: Number of requested cycles that are still to be run in the pause.

    Raises:
        ParameterError: The factor is out of range.
    """

    def __init__(self, real_time_factor: float = 1.0) -> None:
        check_real_time_factor(real_time_factor)
        self.real_time_factor = real_time_factor
        self.paused = False
        self.steps_due = 0

    def passes(self) -> bool:
        """Return whether to run the cycle that is due; in a pause, use up a step."""
        if not self.paused:
            return True
        if self.steps_due == 0:
            return False
        # The cycle that a step permits uses the step up.
        self.steps_due -= 1
        return True

    def resume(self) -> None:
        """Let time pass; requested steps are dropped, as cycles run anyway."""
        self.paused = False
        self.steps_due = 0


def check_real_time_factor(factor: float) -> None:
    """Refuse a real-time factor that is out of range.

    Outside the range a period of wall time overflows or lasts for minutes.

    Args:
        factor: Station time over wall time.

    Raises:
        ParameterError: The factor is not within `SLOWEST` and `FASTEST`.
    """
    if not SLOWEST <= factor <= FASTEST:
        raise ParameterError(
            f"The real-time factor is {factor:g}; allowed are {SLOWEST:g} to "
            f"{FASTEST:g}.",
            remedy="1 is real time; to let time stand still, pause the simulation.",
            details={"real_time_factor": factor},
        )
