"""Pace a control thread by the states of a robot: the wait for them is the sleep."""

from collections.abc import Callable

from station.core.hardware.robot_hw import RobotClock


class RobotPace:
    """Waits for a robot, and tells how late its states come. Control thread only.

    Args:
        robot: The robot.
        now: Wall time [s].
        period: The robot's period [s].

    Attributes:
        woke: When the last wait ended [s].
    """

    def __init__(
        self, robot: RobotClock, now: Callable[[], float], period: float
    ) -> None:
        self._wait = robot.wait
        self._now = now
        self._period = period
        self._last = self.woke = now()

    def wait(self) -> tuple[float, int]:
        """Wait for the next state; return how late it came [s], and elapsed periods.

        The two clocks drift apart, so each state is due a period after the last one.
        """
        elapsed = self._wait()
        self.woke = woke = self._now()
        if not elapsed:
            return 0.0, 0
        lateness = woke - self._last - elapsed * self._period
        self._last = woke
        return max(0.0, lateness), elapsed
