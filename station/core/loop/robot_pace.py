"""Pace a control thread by the states of a robot: the wait for them is the sleep."""

from collections.abc import Callable

from station.core.hardware.robot_hw import RobotClock
from station.core.loop.loop_report import LoopMeter
from station.memory.doubles import Doubles


class RobotPace:
    """Waits for a robot, and tells how late its states come. Control thread only.

    Args:
        robot: The robot.
        now: Wall time [s].
        period: The robot's period [s].
    """

    def __init__(
        self, robot: RobotClock, now: Callable[[], float], period: float
    ) -> None:
        self._wait = robot.wait
        self._now = now
        self._period = period
        self._last = now()

    def wait(self, meter: LoopMeter, beats: Doubles) -> int:
        """Wait for the next state; return how many periods have elapsed.

        The two clocks drift apart, so each state is due a period after the last one.

        Args:
            meter: Is told how late the state has come, and what was skipped.
            beats: Takes the time at which the wait ended.
        """
        elapsed = self._wait()
        woke = self._now()
        beats[0] = woke
        if elapsed:
            lateness = woke - self._last - elapsed * self._period
            meter.woke(max(0.0, lateness), elapsed - 1)
            self._last = woke
        return elapsed
