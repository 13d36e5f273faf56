"""One cycle of the control loop: read, update, write, and note what was."""

from collections.abc import Callable, Sized
from typing import Protocol

import cython

from station.core.control.controller_round import ControllerRound
from station.core.control.records import Records
from station.core.hardware.stages import Stage
from station.core.numerics.durations import CycleTimes
from station.memory.wall_time import VirtualTime, wall_time


class StopFlag:
    """Tells whether a stop waits to be carried out.

    Compiled, it is a field of C, which every cycle reads without a look-up.

    Attributes:
        pending: Whether one does.
    """

    def __init__(self) -> None:
        self.pending = False


class Tap(Protocol):
    """Something that samples every cycle."""

    def take(self, cycle: int, epoch: int, stamp: float, period: float) -> None:
        """Sample a cycle."""


class ControlCycle:
    """Runs the cycles of a loop; a subclass knows what happens around a cycle.

    Args:
        reading: Reads the robot.
        updating: Updates the controllers.
        writing: Writes the commands to the robot.
        times: Where the durations go.
        records: Where every cycle is left.
        now: Returns wall time [s]; None takes the clock of the system.
        virtual: Wall time if that is virtual; `now` is not asked then.
        refresh: Brings the joint states that the records read up to date; None if
            they always are.
        waiting: What is to be done between two cycles; empty in a usual cycle.
        latch: Its `pending` tells whether everything is to be stopped.
        stop_flags: `stop_flags[0]` is not 0 while a watchdog asks for a stop.

    Attributes:
        time: Station time [s].
        cycle: Number of the last cycle.
        epoch: Number that commands must not be older than.
        longest_period: Longest period of a cycle [s].
        late_cycles: By how many periods the next cycle is to begin late.
        taps: What samples every cycle at the moment; replaced as a whole.
    """

    def __init__(
        self,
        *,
        reading: Stage,
        updating: ControllerRound,
        writing: Stage,
        times: CycleTimes,
        records: Records,
        now: Callable[[], float] | None,
        virtual: VirtualTime | None = None,
        refresh: Callable[[], None] | None,
        waiting: Sized,
        latch: StopFlag,
        stop_flags: memoryview,
    ) -> None:
        self.reading = reading
        self.updating = updating
        self.writing = writing
        self.times = times
        updating.leave_in(records)
        self.now = now
        self.virtual = virtual
        self.refresh = refresh
        self.waiting = waiting
        self.latch = latch
        self.stop_flags = stop_flags
        self.taps: tuple[Tap, ...] = ()
        self.time = 0.0
        self.cycle = 0
        self.epoch = 1
        self.longest_period = float("inf")
        self.late_cycles = 0
        if not cython.compiled and now is None and virtual is None:
            # The same, without two calls of Python around it, four times a cycle.
            self.wall_time = wall_time  # type: ignore[method-assign]

    def attend(self) -> object:
        """Do what is to be done between two cycles."""
        raise NotImplementedError

    def obey_watchdog(self) -> None:
        """Carry out the stop that the watchdog asks for."""
        raise NotImplementedError

    def run(self, cycles: int, period: float, tick: float = 0.0) -> int:
        """Run some cycles, fewer if one of them is to begin late.

        Args:
            cycles: How many.
            period: Time since the last cycle, in each of them [s].
            tick: By how much virtual time passes before each of them [s].

        Returns:
            How many were run.
        """
        done = 0
        while done < cycles and not self.late_cycles:
            if self.virtual is not None:
                self.virtual.seconds += tick
            self.run_one(period)
            done += 1
        return done

    def run_one(self, period: float) -> None:
        """Run one cycle.

        Args:
            period: Time since the last cycle [s]; at most `longest_period` counts.
        """
        if period > self.longest_period:
            period = self.longest_period
        time = self.time + period
        self.time = time
        self.cycle += 1
        if self.waiting or self.latch.pending:
            self.attend()
        begun = self.wall_time()
        self.reading.run(time, period)
        read = self.wall_time()
        self.updating.run(time, period)
        if self.stop_flags[0]:
            # A controller that held the thread up has just returned. What it wrote must
            # not reach the robot, so the stop is carried out before the write.
            self.obey_watchdog()
        updated = self.wall_time()
        self.writing.run(time, period)
        self.times.add(begun, read, updated, self.wall_time())
        self.leave(period)

    def wall_time(self) -> float:
        """Return wall time [s]."""
        if self.virtual is not None:
            return self.virtual.seconds
        return wall_time() if self.now is None else self.now()

    def leave(self, period: float) -> None:
        """Leave a record of the cycle."""
        cycle, epoch, time = self.cycle, self.epoch, self.time
        if self.refresh is not None:
            self.refresh()
        self.updating.leave(cycle, epoch, time, period)
        for tap in self.taps:
            tap.take(cycle, epoch, time, period)
