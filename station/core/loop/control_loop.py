"""The loop: read, update, write, at a fixed rate in a thread, or step by step.

Deadlines are absolute. A deadline that has passed when the thread wakes is skipped, and
its cycle is not made up for. Instead the next cycle gets a longer `period`: the
scheduled time since the last cycle, which is a multiple of the nominal period, up to
the longest one that the robot allows. A robot with a clock of its own
(`RobotHW.robot_clock`) paces the thread instead: a cycle begins when its state arrives.

During a pause the thread keeps waking up: it carries out operations, the stop and
switches, but does not write to the robot or update controllers. It sleeps until a far
deadline in slices, so that requests do not have to wait for the deadline.
"""

import threading
from collections.abc import Callable
from math import inf
from typing import TypeVar

import numpy as np

from station.core.clock import Clock, ManualClock
from station.core.control.controller_manager import ControllerManager
from station.core.errors import CONTAINED, LoopError, trace_of_fault
from station.core.hardware.interfaces import JointStateGroup, JointStateInterface
from station.core.hardware.robot_hw import RobotClock, RobotHW
from station.core.loop.control_cycle import ControlCycle
from station.core.loop.cycle_yield import CycleYield
from station.core.loop.heartbeat import Heartbeat, LoopLife
from station.core.loop.operations import Operations, guarded
from station.core.loop.simulation_speed import SimulationSpeed
from station.core.loop.snapshot import SnapshotRing
from station.core.loop.stop_latch import StopLatch
from station.core.numerics.durations import CycleTimes, DurationRing, percentiles_of
from station.core.scheduling import (
    keep_interpreter,
    let_others_in,
    request_realtime_priority,
    switch_interval_kept,
)
from station.reports import LoopReport, LoopState


class LoopMeter:
    """Measures the times of cycles, without allocation; the control thread calls it.

    Args:
        clock: Wall time.

    Attributes:
        times: Durations of the cycles.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._lateness = DurationRing()
        self.times = CycleTimes()
        self._since = self.times.last = clock.now()
        self._skipped = 0
        self._skipped_before = 0

    @property
    def total_skipped(self) -> int:
        """Number of deadlines ever skipped; a reset does not change it."""
        return self._skipped

    def reset(self) -> None:
        """Start the statistics anew."""
        self._lateness.reset()
        self.times.reset()
        self._since = self.times.last = self._clock.now()
        # The total is kept, because others count with it.
        self._skipped_before = self._skipped

    def woke(self, lateness: float, skipped: int) -> None:
        """Note how late the thread woke [s] and how many deadlines had passed."""
        self._lateness.add(lateness)
        self._skipped += skipped

    def idled(self) -> None:
        """Note that the thread woke while time stands still; it counts for nothing."""
        now = self._clock.now()
        # Time in a pause must not lower the achieved rate.
        self._since += now - self.times.last
        self.times.last = now

    def report(
        self,
        *,
        state: LoopState,
        failure: str,
        period: float,
        real_time_factor: float,
        scheduler: str,
    ) -> LoopReport:
        """Summarise the cycles since the last reset. Any thread.

        Args:
            state: Whether the thread runs.
            failure: Traceback of the error that ended it; empty without an error.
            period: Nominal period in station time [s], > 0.
            real_time_factor: Station time over wall time, as asked for, > 0.
            scheduler: Scheduling class granted to the thread, in words.
        """
        times = self.times
        elapsed = times.last - self._since
        cycles, skipped = times.count, self._skipped - self._skipped_before
        parts = np.asarray(times.rows).reshape(-1, 4)[:cycles].T.copy()
        rate = real_time_factor / period
        achieved = cycles / elapsed if elapsed > 0.0 else 0.0
        simulated = (cycles + skipped) * period
        return LoopReport(
            state=state,
            failure=failure,
            rate=rate,
            achieved_rate=achieved,
            period=period,
            cycles=cycles,
            skipped=skipped,
            real_time_factor=real_time_factor,
            achieved_real_time_factor=simulated / elapsed if elapsed > 0.0 else 0.0,
            lateness=self._lateness.percentiles(),
            read=percentiles_of(parts[0], times.longest_read, cycles),
            update=percentiles_of(parts[1], times.longest_update, cycles),
            write=percentiles_of(parts[2], times.longest_write, cycles),
            total=percentiles_of(parts[3], times.longest_total, cycles),
            scheduler=scheduler,
        )


T = TypeVar("T")

SLICE = 0.005
"""Longest sleep of the control thread [s wall time].

It bounds how long a stop, a switch or an operation waits at a small real-time factor.
Sleeping in slices needs no lock; an event or a condition to wake the thread would."""


class ControlLoop:
    """Runs a robot and its controllers.

    Either `start` and `stop` a thread, or call `step` for a deterministic run with
    the same code. One thread at a time: `step` is refused while the thread runs.

    Args:
        hw: The robot, initialised.
        manager: Its controllers.
        clock: Wall time.
        period: Nominal period [s], > 0.
        real_time_factor: Station time over wall time of the thread, 0.01 to 100.
        update_budget: How long an update of one controller may take in the thread [s
            wall time], > 0; None for `period`, infinite for no budget.
        snapshots: Ring that receives a snapshot in every cycle.
        heartbeat: The page shared with a watchdog; None for a page of this process.

    Attributes:
        control_cycle: Runs the cycles, and operations between them.
        stop_latch: The latched stop; carried out between two cycles.
        speed: Whether and how fast station time passes in the thread.
        heartbeat: Page with the time of every wake-up, in which a watchdog asks for a
            stop.
        cycle_yield: Tells other threads when to wait for the control thread.

    Raises:
        ParameterError: The real-time factor is out of range.
    """

    def __init__(
        self,
        hw: RobotHW,
        manager: ControllerManager,
        *,
        clock: Clock,
        period: float = 0.001,
        real_time_factor: float = 1.0,
        update_budget: float | None = None,
        snapshots: SnapshotRing | None = None,
        heartbeat: Heartbeat | None = None,
    ) -> None:
        self.hw = hw
        self.manager = manager
        self.clock = clock
        self.period = period
        self.speed = SimulationSpeed(real_time_factor)
        self.snapshots = snapshots or SnapshotRing()
        self.stop_latch = StopLatch()
        self.heartbeat = heartbeat or Heartbeat()
        self.cycle_yield = CycleYield(clock, self.heartbeat, period, self.speed)
        interface = hw.get(JointStateInterface)
        self._robot_clock = hw.robot_clock()
        self._joints = JointStateGroup(interface.handles() if interface else [])
        self._update_budget = period if update_budget is None else update_budget
        self._meter = LoopMeter(clock)
        self._operations = Operations()
        # Room for eight numbers per joint; larger samples are kept as objects.
        room = 64 + 8 * len(self._joints.names)
        self.snapshots.prepare(self._joints.blocks, room)
        self.control_cycle = ControlCycle(
            hw,
            manager,
            self._joints,
            snapshots=self.snapshots,
            operations=self._operations,
            stop_latch=self.stop_latch,
            heartbeat=self.heartbeat,
            times=self._meter.times,
            clock=clock,
        )
        self._thread: threading.Thread | None = None
        self._stopping = False
        self._state = LoopState.STOPPED
        self._failure = ""
        self._scheduler = ""
        manager.pump = self.step
        manager.period = period
        manager.loop_cycle = lambda: self.cycle
        # A switch posted before a stop must not start anything after it.
        manager.lifecycle.start_gate = self.stop_latch.check

    @property
    def time(self) -> float:
        """Station time [s]."""
        return self.control_cycle.time

    @property
    def cycle(self) -> int:
        """Number of the last cycle."""
        return self.control_cycle.cycle

    @property
    def epoch(self) -> int:
        """The station's epoch; commands of an older epoch are void."""
        return self.control_cycle.epoch

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints in the snapshots, in their order."""
        return list(self._joints.names)

    @property
    def skipped(self) -> int:
        """Number of deadlines ever skipped; a reset does not change it."""
        return self._meter.total_skipped

    @property
    def state(self) -> LoopState:
        """Return the state of the thread: running, stopped, or dead."""
        return self._state

    @property
    def advances(self) -> bool:
        """True while the thread makes cycles by itself: it runs and is not paused."""
        return self._state is LoopState.RUNNING and not self.speed.paused

    def start(self) -> None:
        """Run in a thread of its own until `stop`.

        Raises:
            LoopError: The loop runs already.
        """
        if self._thread is not None:
            raise LoopError("The control loop runs already.", remedy="Stop it first.")
        self._stopping = False
        self._failure = ""
        self._meter.reset()
        self._state = LoopState.RUNNING
        # Before the thread runs: the watchdog must not take its start for a standstill.
        self.heartbeat.beats[0] = self.clock.now()
        self.heartbeat.life = LoopLife.RUNNING
        # From here on the thread runs the cycles that a switch waits for.
        self.manager.pump = None
        self.manager.controller_update.update_budget = self._update_budget
        self._thread = threading.Thread(target=self._run, name="control", daemon=True)
        self._thread.start()

    def stop(self, timeout: float = 2.0) -> None:
        """End the thread after the current cycle; does nothing when there is none.

        Raises:
            LoopError: The cycle did not end within `timeout` [s].
        """
        thread = self._thread
        if thread is None:
            return
        self._stopping = True
        thread.join(timeout)
        if thread.is_alive():
            raise LoopError(
                f"The control thread did not end within {timeout} s.",
                remedy="A cycle hangs in the hardware or in a controller.",
            )
        self.manager.end_async_threads()
        self._be_stepped()
        if self._state is LoopState.RUNNING:
            self._state = LoopState.STOPPED

    def step(self, cycles: int = 1, tick: float = 0.0) -> None:
        """Run `cycles` cycles now, without waiting for the clock.

        Args:
            cycles: Number of cycles.
            tick: Advance of a manual clock before each of them [s].

        Raises:
            LoopError: The thread runs.
        """
        if self._thread is not None:
            raise LoopError(
                "Cannot step: the control loop runs in its thread.",
                remedy="Stop the loop first.",
            )
        control_cycle = self.control_cycle
        while cycles > 0:
            if not control_cycle.late_cycles:
                cycles -= control_cycle.run_cycles(cycles, self.period, tick)
                continue
            cycles -= 1
            if isinstance(self.clock, ManualClock):
                self.clock.advance(tick)
            late = self._take_late_cycles()
            self._meter.woke(late * self.period / self.speed.real_time_factor, late)
            # A cycle that a test makes late has the period of a late thread's cycle.
            control_cycle.run_cycle((1 + late) * self.period)

    def wait_between_cycles(self) -> None:
        """Wait until a cycle has just ended; return at once without a thread."""
        if self._thread is not None:
            self.cycle_yield.wait_for_begun_cycle()

    def go_on_without_thread(self) -> bool:
        """Continue by steps, in a copy of the process that lacks the thread.

        Returns:
            Whether no cycle was under way, so that the next one can follow.
        """
        is_whole = self.snapshots.newest == self.cycle
        self._be_stepped()
        self._state = LoopState.STOPPED
        return is_whole

    def _be_stepped(self) -> None:
        self._thread = None
        self.manager.pump = self.step
        # Steps do not follow the wall clock.
        self.manager.controller_update.update_budget = inf

    def run_in_cycle(
        self, action: Callable[[], T], timeout: float = 1.0, *, moves: bool = False
    ) -> T:
        """Run `action` in the control thread between two cycles; return its result.

        Runs it at once when no thread runs, or when called from the control thread.

        Args:
            action: Short, and must not wait for anything.
            timeout: How long to wait for it [s wall time].
            moves: Whether the action can move the robot; it is then refused while the
                station is stopped.

        Raises:
            StoppedError: `moves` is true and the station is stopped.
            LoopError: The loop died, or did not run the action in time; it will not run
                it later.
        """
        thread = self._thread
        # Checked again in the cycle: the stop may come between the request and the
        # operation.
        if moves:
            action = guarded(self.stop_latch.check, action)
        # Without a thread the caller makes the cycles itself. In the control thread,
        # waiting would never end.
        if thread is None or thread is threading.current_thread():
            return action()
        operation = self._operations.post(action)
        self.check_alive()  # after it: a loop that dies later gives it up
        details = {"state": self._state.value, "failure": self._failure}
        return operation.outcome(timeout, details)  # type: ignore[return-value]  # of this action

    def check_alive(self) -> None:
        """Refuse if the loop has died, because nothing moves any more.

        Raises:
            LoopError: The loop has died; the message states the reason.
        """
        if self._state is LoopState.FAILED:
            raise self._death()

    def report(self) -> LoopReport:
        """Return the state and the statistics of the loop. Any thread."""
        return self._meter.report(
            state=self._state,
            failure=self._failure,
            period=self.period,
            real_time_factor=self.speed.real_time_factor,
            scheduler=self._scheduler,
        )

    def reset_statistics(self) -> None:
        """Start the statistics anew."""
        self.run_in_cycle(self.begin_statistics)

    def begin_statistics(self) -> None:
        """Start the statistics anew; control thread or between cycles."""
        self._meter.reset()

    def delay_next_cycle(self, cycles: int) -> None:
        """Delay the next cycle, as a busy machine delays the thread.

        Args:
            cycles: Delay in periods, >= 0; their deadlines are skipped and counted.
        """
        self.control_cycle.late_cycles = cycles

    def _take_late_cycles(self) -> int:
        late, self.control_cycle.late_cycles = self.control_cycle.late_cycles, 0
        return late

    def age(self) -> float:
        """Return the time since the control thread last woke up [s wall time]."""
        return self.clock.now() - self.heartbeat.beats[0]

    def failure_summary(self) -> str:
        """Return the last line of the error that ended the thread; empty if none."""
        return self._failure.strip().rpartition("\n")[2]

    def _run(self) -> None:
        self._scheduler = request_realtime_priority()
        try:
            with switch_interval_kept():
                self._run_until_stopped()
        except BaseException:  # noqa: BLE001 - the boundary: kept, shown, nothing moves on
            self._failure = trace_of_fault()
            self._state = LoopState.FAILED
            # First of all, before code that can hang or raise: the watchdog then makes
            # a real arm hold.
            self.heartbeat.life = LoopLife.DIED
            self._end_what_ran()
        else:
            self.heartbeat.life = LoopLife.STOPPED

    def _end_what_ran(self) -> None:
        """Stop the controllers of a loop that died, and wake its waiting callers."""
        try:
            self.control_cycle.carry_out_stop(self.failure_summary())
        except CONTAINED:
            # The robot itself may have failed. Both errors are needed to see why.
            self._failure = f"{trace_of_fault()}\nAfter:\n{self._failure}"
        self._operations.give_up(self._death())

    def _death(self) -> LoopError:
        return LoopError(
            f"The control loop died: {self.failure_summary()}",
            remedy="Restart the station; the report of the loop has the traceback.",
            details={"failure": self._failure},
        )

    def _run_until_stopped(self) -> None:
        if self._robot_clock is not None:
            self._run_at_the_pace_of(self._robot_clock)
            return
        speed, beats = self.speed, self.heartbeat.beats
        deadline = self.clock.now() + self.period / speed.real_time_factor
        while not self._stopping:
            factor = speed.real_time_factor
            wall_period = self.period / factor
            let_others_in()
            # During a pause, late cycles are kept for the first cycle after it.
            late = 0 if speed.paused else self._take_late_cycles()
            wake = deadline + late * wall_period
            # A long sleep would keep a stop waiting.
            if (1 + late) * wall_period > SLICE:
                self._sleep_in_slices(wake)
                if self._stopping or speed.real_time_factor != factor:
                    # The deadline was computed with the factor of before.
                    deadline = self.clock.now() + self.period / speed.real_time_factor
                    continue
            else:
                self.clock.sleep_until(wake)
            keep_interpreter()
            # Read once, so that the beat and the lateness are of the same moment.
            now = self.clock.now()
            beats[0] = now
            lateness = now - deadline
            # Missed cycles are skipped, not made up for: a burst would hit the robot
            # with old commands.
            skipped = int(lateness / wall_period)
            if not speed.passes():
                self.control_cycle.run_standstill()
                self._meter.idled()
            elif speed.paused:
                # A step has the nominal period, however late it is.
                self.control_cycle.run_cycle(self.period)
            else:
                self._meter.woke(lateness, skipped)
                self.control_cycle.run_cycle((1 + skipped) * self.period)
            # Counted from the deadline rather than from now, so that one late cycle
            # does not shift all later ones.
            deadline += (1 + skipped) * wall_period

    def _run_at_the_pace_of(self, robot: RobotClock) -> None:
        """Run a cycle for each state of a robot; the wait for a state is the sleep.

        The two clocks drift apart, so a state is due one period after the last one.
        """
        clock, beats = self.clock, self.heartbeat.beats
        last = clock.now()
        while not self._stopping:
            let_others_in()
            elapsed = robot.wait()
            now = clock.now()
            beats[0] = now
            keep_interpreter()
            if elapsed:
                # `elapsed` has the cycles that the robot counted; only the rest of the
                # time is due to the machine.
                lateness = now - last - elapsed * self.period
                self._meter.woke(max(0.0, lateness), elapsed - 1)
                last = now
                self.control_cycle.run_cycle(elapsed * self.period)
            else:
                self.control_cycle.run_standstill()

    def _sleep_in_slices(self, deadline: float) -> None:
        """Sleep until `deadline`, the end of the loop, or a change of the speed."""
        clock, speed = self.clock, self.speed
        factor, now = speed.real_time_factor, clock.now()
        while now < deadline and not self._stopping:
            clock.sleep_until(min(deadline, now + SLICE))
            now = clock.now()
            self.heartbeat.beats[0] = now
            if factor < 1.0:
                # Only a simulated world is slowed down, and stands still between its
                # cycles. A real robot is read once per cycle at any rate.
                self.control_cycle.run_standstill()
            if speed.real_time_factor != factor:
                return
