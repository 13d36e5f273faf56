"""Bring the state of an arm up to date, once per cycle."""

from collections.abc import Callable

from station.core.hardware.stages import Stage
from station.hw.franka.arm.flags import MotionFlags
from station.memory.finite_check import FiniteCheck


class FingerReading:
    """Reads the fingers of a hand, once per cycle."""

    def read(self) -> None:
        """Read the fingers."""
        raise NotImplementedError


class ArmReading(Stage):
    """Reads an arm once per elapsed cycle time.

    Args:
        read_once: Brings the arm's next state.
        readings: Looks for a reading that is not finite.
        motion: The motion that may wait for the arm.
        cycle_time: Duration of the arm's cycle [s], > 0.
        catch_up: Reads the arm as often as the time that is due demands, and takes that
            time from `time_due`; returns how often. For any number but one.
        end_motion: Called when a reading is not finite.

    Attributes:
        time_due: Time for which the arm has not been read yet [s].
        nominal: Cycles of the arm per cycle of the loop.
        bad: Number of a reading that is not finite; -1 when all are.
        fingers: Reads the fingers; None without a simulated hand.
    """

    def __init__(
        self,
        read_once: Callable[[], object],
        readings: FiniteCheck,
        motion: MotionFlags,
        *,
        cycle_time: float,
        catch_up: Callable[[], int],
        end_motion: Callable[[], None],
    ) -> None:
        self.read_once = read_once
        self.readings = readings
        self.motion = motion
        self.cycle_time = cycle_time
        self.catch_up = catch_up
        self.end_motion = end_motion
        self.fingers: FingerReading | None = None
        self.time_due = 0.0
        self.nominal = 1
        self.bad = -1

    def run(self, time: float, period: float) -> None:
        """Read the arm; see `Stage.run`."""
        self.time_due += period
        share, count = self.time_due / self.cycle_time, 1
        if self.nominal == 1 and 0.5 < share < 1.5:
            self.time_due -= self.cycle_time
            self.read_once()
        else:
            count = self.catch_up()
        if self.motion.is_waiting:
            self.motion.advance(count)
        self.bad = self.readings.first_bad()
        if self.bad >= 0:
            # A controller that used such a reading would command garbage.
            self.end_motion()
        if self.fingers is not None:
            self.fingers.read()
