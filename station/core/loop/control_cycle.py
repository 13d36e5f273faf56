"""One cycle of the control loop: waiting operations, read, update, write.

This module alone fixes the order of a cycle, also while time stands still; the loop
decides when a cycle begins.
"""

from typing import TYPE_CHECKING, Any

import cython

from station.core.clock import Clock, SystemClock
from station.core.control.controller_manager import ControllerManager
from station.core.hardware.interfaces import JointStateGroup
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.services import InterruptibleServices, find_services
from station.core.loop.heartbeat import Heartbeat
from station.core.loop.operations import Operations
from station.core.loop.snapshot import SnapshotRing
from station.core.loop.stop_latch import StopLatch
from station.core.numerics.durations import CycleTimes
from station.memory.wall_time import VirtualTime, wall_time

if TYPE_CHECKING:
    from station.core.loop.cycle_tap import CycleTap

_INF = float("inf")


class ControlCycle:
    """Runs the cycles of a robot and its controllers; for the control thread.

    Args:
        hw: The robot, initialised.
        manager: Its controllers.
        joints: The joints whose states every row of the snapshots has.
        snapshots: Ring that receives a row in every cycle.
        operations: Operations of other threads between two cycles.
        stop_latch: The latched stop.
        heartbeat: Page in which a watchdog asks for a stop.
        times: Takes the durations of every cycle.
        clock: Wall time.

    Attributes:
        time: Station time [s].
        cycle: Number of the last cycle.
        epoch: The station's epoch; commands of an older epoch are void.
        longest_period: Longest period of a cycle [s].
        late_cycles: Number of periods by which the next cycle is to be late.
        taps: The open taps; the tuple is replaced as a whole.
    """

    def __init__(
        self,
        hw: RobotHW,
        manager: ControllerManager,
        joints: JointStateGroup,
        *,
        snapshots: SnapshotRing,
        operations: Operations,
        stop_latch: StopLatch,
        heartbeat: Heartbeat,
        times: CycleTimes,
        clock: Clock,
    ) -> None:
        self.hw = hw
        self.manager = manager
        self.controllers = manager.controller_update
        # Bound once, because looking up a method in every cycle takes time.
        self.mode = hw.mode
        self.refresh_joints = joints.refresh
        self.snapshots = snapshots
        self.operations = operations
        self.waiting = operations.waiting
        self.stop_latch = stop_latch
        self.latch_flag = stop_latch.flag
        self.heartbeat = heartbeat
        self.stop_flags = heartbeat.flags
        self.times = times
        self.now = None if isinstance(clock, SystemClock) else clock.now
        self.virtual = clock if isinstance(clock, VirtualTime) else None
        self.interruptible = [
            one for one in find_services(hw) if isinstance(one, InterruptibleServices)
        ]
        self.taps: tuple[CycleTap[Any], ...] = ()
        self.time = 0.0
        self.cycle = 0
        self.epoch = 1
        world = hw.simulated_world()
        # The longest period of a simulated world is known once it is initialised. While
        # other programs command the robot, their server changes this.
        self.longest_period = _INF if world is None else world.longest_period()
        self.late_cycles = 0
        if not cython.compiled and self.now is None and self.virtual is None:
            # The same time without two calls in Python, four times per cycle.
            self.wall_time = wall_time  # type: ignore[method-assign]

    def run_cycles(self, cycles: int, period: float, tick: float = 0.0) -> int:
        """Run some cycles, fewer if one of them is to begin late.

        Args:
            cycles: Number of cycles.
            period: Time since the last cycle, in each of them [s].
            tick: Advance of virtual time before each of them [s].

        Returns:
            Number of cycles that were run.
        """
        done = 0
        while done < cycles and not self.late_cycles:
            if self.virtual is not None:
                self.virtual.seconds += tick
            self.run_cycle(period)
            done += 1
        return done

    def run_cycle(self, period: float) -> None:
        """Run one cycle.

        Args:
            period: Time since the last cycle [s]; at most `longest_period` counts.
        """
        # A simulated world advances by this much at most; station time must not run
        # ahead of it.
        if period > self.longest_period:
            period = self.longest_period
        time = self.time + period
        self.time = time
        self.cycle += 1
        # Before the read, so that an operation sees one whole state, of the last cycle.
        if self.waiting or self.latch_flag[0]:
            self.carry_out_requests()
        # Looked up first: the interpreter finds an instance's attribute sooner than a
        # method.
        read_robot, write_robot = self.hw.read, self.hw.write
        begun = self.wall_time()
        read_robot(time, period)
        read = self.wall_time()
        self.controllers.update_controllers(time, period)
        if self.stop_flags[0]:
            # A controller that blocked the thread has just returned. Its commands must
            # not reach the robot, so the stop is carried out before the write.
            self.obey_watchdog()
        updated = self.wall_time()
        write_robot(time, period)
        self.times.add(begun, read, updated, self.wall_time())
        # After the write, so that a snapshot has the commands that the robot received.
        self.leave_row(period)

    def run_standstill(self) -> None:
        """Carry out waiting requests while time stands still, and leave a snapshot.

        No controller is updated and nothing is written. The robot is read when
        something may have changed it.
        """
        if self.stop_flags[0]:
            self.obey_watchdog()
            changed = True
        else:
            # An operation in a pause may have moved the simulated world, so the robot
            # is read and a snapshot left.
            changed = self.carry_out_requests()
        if self.controllers.advance_switch(self.time) or changed:
            self.cycle += 1
            self.hw.read(self.time, 0.0)
            self.leave_row(0.0)

    def wall_time(self) -> float:
        """Return wall time [s]."""
        if self.virtual is not None:
            return self.virtual.seconds
        return wall_time() if self.now is None else self.now()

    def leave_row(self, period: float) -> None:
        """Leave the row of a cycle in the ring, for readers in other threads."""
        cycle, epoch, time = self.cycle, self.epoch, self.time
        if self.refresh_joints is not None:
            self.refresh_joints()
        running = self.controllers.gate.running
        self.snapshots.leave_row(cycle, epoch, time, period, self.mode(), running)
        for tap in self.taps:
            tap.sample_cycle(cycle, epoch, time, period)

    def carry_out_requests(self) -> bool:
        """Carry out operations and the stop; return whether there were any."""
        changed = self.operations.run_operations()
        if self.stop_latch.pending:
            self.carry_out_stop()
            changed = True
        return changed

    def carry_out_stop(self, failure: str = "") -> None:
        """Stop every controller now; also when no thread runs.

        Args:
            failure: Why the loop died, if it did.
        """
        why = self.stop_latch.reason or failure or "no reason given"
        # Before the controllers stop: a command that arrives from now on belongs to the
        # new epoch.
        self.next_epoch(f"The station was stopped: {why.rstrip('.')}.")
        self.manager.stop_all(self.time)
        if self.stop_latch.pending:
            # When the loop dies all controllers stop, too, although the latch is not
            # engaged.
            self.stop_latch.carried_out(self.cycle)

    def obey_watchdog(self) -> None:
        """Carry out the stop that the watchdog asks for."""
        self.stop_latch.engage(self.heartbeat.stop_reason())
        self.carry_out_stop()
        self.heartbeat.confirm_stop()

    def next_epoch(self, reason: str) -> int:
        """Make everything commanded so far void; control thread or between cycles.

        Args:
            reason: Why, in one sentence; goals and gripper motions end with it.
        """
        self.epoch += 1
        self.controllers.lifecycle.void_commands(reason)
        # Gripper motions run in threads of their own, so they are interrupted here.
        for services in self.interruptible:
            services.interrupt(reason)
        return self.epoch

    def begin_anew(self) -> None:
        """Void all commands and restart the running controllers in the next cycle.

        Called when a simulated world was reset; control thread or between cycles.
        """
        self.next_epoch("A reset put the simulated world back to its start.")
        self.controllers.resets = True
