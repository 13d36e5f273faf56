"""The manager's update in a cycle: controllers, switches, faults and commands.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp, update;
differs: nothing that a controller does ends the update (CM-80).
"""

from typing import TYPE_CHECKING

import cython

from station.core.control.controller import ControllerState
from station.core.control.controller_lifecycle import ControllerLifecycle
from station.core.control.loaded_controller import LoadedController
from station.core.control.pending_switch import PendingSwitch, SwitchProgress
from station.core.control.switch_transaction import SwitchTransaction
from station.core.errors import CONTAINED, SwitchRefusedError, reason_of, trace_of_fault
from station.memory.wall_time import wall_time

if cython.compiled:
    from cython.cimports.cpython.pythread import PyThread_get_thread_ident as get_ident
else:
    from threading import get_ident

if TYPE_CHECKING:
    from collections.abc import Callable

_RUNNING = ControllerState.RUNNING
_INF = float("inf")

LATE_UPDATES = 100
"""Number of updates in a row over the budget after which a controller is stopped. A
single one may be due to another process that had the processor."""
LONGEST_UPDATE = 0.25
"""Duration of an update that counts as a stall [s]: the second stall within
`STALL_MEMORY` stops the controller. A single stall may be due to the machine, which may
keep the thread that has the interpreter lock off the processor for that long."""
STALL_MEMORY = 10.0
"""Time for which a stall counts [s station time]."""


class StateChanges:
    """Marks changes of the set of running controllers, for readers in other threads.

    No thread waits for a lock: a reader compares `count` before and after it reads, and
    reads again after a change. A change is a `with` block, which may contain another.

    Attributes:
        count: Odd during a change; grows with each change.
    """

    def __init__(self) -> None:
        self.count = 0
        self._depth = 0

    def __enter__(self) -> None:
        self._depth += 1
        if self._depth == 1:
            self.count += 1

    def __exit__(self, *_: object) -> None:
        self._depth -= 1
        if self._depth == 0:
            self.count += 1


class ControllerUpdate:
    """Updates the loaded controllers; every method is for the control thread.

    It never waits: callers replace `lifecycle.loaded` and put a switch into `pending`;
    the control thread looks at both once per cycle.

    Args:
        lifecycle: Starts and stops the controllers, and has the list of them.

    Attributes:
        lifecycle: As given.
        gate: Keeps the commands with their owners; knows which controllers run.
        interrupted: Names of the controllers that were stopped when the robot last did
            not carry out their commands.
        changes: Marks the changes of the running controllers.
        update_budget: How long an update may take [s]; infinite without a budget.
        cycle: Number of cycles.
        time: Station time of the last cycle [s].
        thread: The thread of the last cycle.
        is_updating: Whether a cycle's update is under way.
        pending: The switch under way; None without one.
        resets: Whether the next cycle restarts all controllers first.
        stopwatch: Returns wall time [s]; None takes the clock of the system.
    """

    def __init__(self, lifecycle: ControllerLifecycle) -> None:
        self.lifecycle = lifecycle
        self.gate = lifecycle.gate
        self.hw = lifecycle.hw
        # Bound once, because looking up a method in every cycle takes time.
        self.is_interrupted = lifecycle.hw.is_interrupted
        self.interrupted: tuple[str, ...] = ()
        self.changes = StateChanges()
        self.update_budget = _INF
        self.cycle = 0
        self.time = 0.0
        self.thread = 0
        self.is_updating = False
        self.pending: PendingSwitch | None = None
        self.transaction: SwitchTransaction | None = None
        self.resets = False
        self.stopwatch: Callable[[], float] | None = None

    def update_controllers(
        self,
        time: float,
        period: float,
        stands_still: bool = False,  # noqa: FBT001, FBT002 - a C function
    ) -> None:
        """Update the running controllers, advance a switch, write all commands.

        Args:
            time: Station time [s], >= 0.
            period: Time since the last cycle [s], >= 0.
            stands_still: Whether time stands still, and no controller is updated.

        Raises:
            ValueError: `time` or `period` is negative or not finite.
        """
        # A negative or unknown period would corrupt integrators and filters.
        if not (0.0 <= time < _INF and 0.0 <= period < _INF):
            self.resets = False  # a cycle that is refused changes nothing
            raise ValueError(
                f"Cannot update at time {time} s after a period of {period} s: both "
                "must be finite and not negative."
            )
        self.thread = get_ident()
        self.is_updating = True
        self.cycle += 1
        self.time = time
        # Another thread may unload a controller that fails below, within this update.
        gate = self.gate
        try:
            if not stands_still:
                # Three rare cases; the usual cycle makes only this test.
                if gate.traced_cycles or self.resets or self.is_interrupted():
                    self._stop_or_restart(time)
                last = None
                # `running` is valid while no controller has started or stopped;
                # otherwise the loop goes through all of them.
                for one in () if gate.is_stale else gate.running:
                    if one.controller.state is _RUNNING:
                        self.update_controller(one, time, period)
                        if gate.is_stale:
                            last = one
                            break
                if gate.is_stale:
                    # A controller has started or stopped, e.g. the last one failed.
                    loaded = self.lifecycle.loaded
                    after = 0 if last is None else loaded.index(last) + 1
                    self._update_all(loaded[after:], time, period)
            pending = self.pending
            if pending is not None:
                self._advance(pending, time, period, stands_still=stands_still)
            if gate.is_stale:
                self._note_owners(time)
            else:
                gate.keep_commands()
        finally:
            self.is_updating = False

    def advance_switch(self, time: float) -> bool:
        """Advance a pending switch while time stands still.

        Args:
            time: Station time [s].

        Returns:
            Whether there was a switch.
        """
        if self.pending is None:
            return False
        self.update_controllers(time, 0.0, stands_still=True)
        return True

    def update_controller(
        self, one: LoadedController, time: float, period: float
    ) -> None:
        """Update one controller if its rate says so, and check its commands."""
        elapsed = one.count_cycle(period) if one.every > 1 else period
        if elapsed < 0.0:
            return
        stopwatch = self.stopwatch
        begin = wall_time() if stopwatch is None else stopwatch()
        try:
            one.controller.update(time, elapsed)
        except CONTAINED as error:
            self._fail(one, time, reason_of("update", error), trace_of_fault())
            if self.gate.traced_cycles:
                self._find_intrusion(one, time)
            return
        is_finite = True
        for block in one.blocks:
            if not block.copy_commands():
                is_finite = False
        duration = (wall_time() if stopwatch is None else stopwatch()) - begin
        times = one.times
        times.add(duration)
        # In a standstill the period is zero, and nothing is late.
        if duration > period and period > 0.0:
            times.overruns += 1
            times.last_overrun = time
        if not is_finite or one.fresh:
            self._check_commands(one, time, is_finite=is_finite)
        if duration > self.update_budget or times.late_updates:
            self._judge_duration(one, time, duration)
        if self.gate.traced_cycles:
            self._find_intrusion(one, time)

    def _stop_or_restart(self, time: float) -> None:
        """Stop interrupted controllers; restart all after a reset."""
        gate, lifecycle = self.gate, self.lifecycle
        with self.changes:
            if gate.traced_cycles:
                gate.restore_commands()
            if self.is_interrupted():
                self._stop_interrupted(time)
            if self.resets:
                self.resets = False
                gate.forget_rest()
                for one in lifecycle.loaded:
                    lifecycle.reset(one, time)

    def _note_owners(self, time: float) -> None:
        lifecycle = self.lifecycle
        if lifecycle.has_chains:
            with self.changes:
                lifecycle.settle_chains(time)
        self.gate.note_owners(lifecycle.loaded)

    def _update_all(
        self, loaded: tuple[LoadedController, ...], time: float, period: float
    ) -> None:
        for one in loaded:
            if one.controller.state is _RUNNING:
                self.update_controller(one, time, period)

    def _check_commands(
        self, one: LoadedController, time: float, *, is_finite: bool
    ) -> None:
        refused = None if is_finite else one.commands.refused()
        if refused is not None:
            self._fail(one, time, f"update wrote the {refused}", None)
        # The first update is checked for a jump once its commands are known finite.
        elif one.fresh:
            with self.changes:
                self.lifecycle.check_first_update(one, time)

    def _find_intrusion(self, one: LoadedController, time: float) -> None:
        intrusion = self.gate.find_intrusion(one, self.lifecycle.loaded)
        if intrusion is not None:
            problem = f"update wrote {intrusion}, which it has not claimed"
            self._fail(one, time, problem, None)

    def _fail(
        self, one: LoadedController, time: float, problem: str, trace: str | None
    ) -> None:
        with self.changes:
            self.lifecycle.fail_chain(one, time, problem, trace)

    def _judge_duration(
        self, one: LoadedController, time: float, duration: float
    ) -> None:
        """Stop a controller whose updates keep taking longer than the budget."""
        times = one.times
        # A single update in time ends the row.
        if duration <= self.update_budget or one.controller.state is not _RUNNING:
            times.late_updates = 0
            return
        times.late_updates += 1
        is_stalled_again = False
        if duration >= LONGEST_UPDATE:
            is_stalled_again = time - times.stalled_at <= STALL_MEMORY
            times.stalled_at = time
        if times.late_updates >= LATE_UPDATES:
            often = f"{LATE_UPDATES} in a row"
        elif is_stalled_again:
            often = f"and one within {STALL_MEMORY:g} s before it as long"
        else:
            return
        self._fail(
            one,
            time,
            f"update took {milliseconds(duration)}, {often}; an update may take at "
            f"most {milliseconds(self.update_budget)}",
            None,
        )

    def _stop_interrupted(self, time: float) -> None:
        """Stop the controllers whose commands the robot does not carry out."""
        found: list[LoadedController] = []
        for one in self.lifecycle.loaded:
            reason: str | None = None
            if one.controller.state is _RUNNING:
                reason = self.hw.interruption_of(one.info)
            if reason:
                found.append(one)
                one.abort_goals(f"The robot ended the motion: {reason}.")
                self.lifecycle.stop(one, time)
                # A fault in `stopping` says more than the robot's reason.
                one.fault = one.fault or reason
                one.commands.write_rest()
        if found:
            self.interrupted = tuple(one.info.name for one in found)
            self.lifecycle.release(found)

    def stop_all(self, time: float) -> None:
        """Stop every controller, rest the robot, and end a switch that is under way.

        Args:
            time: Station time [s].
        """
        pending = self.pending
        with self.changes:
            # End the switch first: it must not start anything after the stop.
            involved = [] if pending is None else self._end(pending, time)
            loaded = self.lifecycle.loaded
            running = [one for one in loaded if one.controller.is_running()]
            for one in running:
                self.lifecycle.stop(one, time)
                one.commands.write_rest()
            if running or involved:
                self.lifecycle.release(list(dict.fromkeys((*running, *involved))))

    def _end(self, pending: PendingSwitch, time: float) -> list[LoadedController]:
        """End a switch under way; return its controllers.

        If its caller has withdrawn it already, nothing happens.
        """
        if pending.progress is SwitchProgress.POSTED:
            if not pending.claim.acquire(blocking=False):
                # The caller has just withdrawn it and does not wait.
                return []
            involved: list[LoadedController] = []
        else:
            involved = [*pending.start, *pending.stop]
        for one in dict.fromkeys(pending.start):
            if one.controller.state is ControllerState.WAITING:
                self.lifecycle.abort(one, time, "everything was stopped")
        pending.error = SwitchRefusedError(
            "Everything was stopped before the switch was finished.",
            remedy="Release the stop, look at the state, and switch again.",
        )
        self._finish(pending)
        return involved

    def _advance(
        self, pending: PendingSwitch, time: float, period: float, *, stands_still: bool
    ) -> None:
        if not stands_still:
            # A reset of the world during a pause has changed the commands.
            self.gate.restore_commands()
        transaction = self.transaction
        if pending.progress is SwitchProgress.POSTED or transaction is None:
            if not pending.claim.acquire(blocking=False):
                return  # withdrawn by its caller
            pending.progress = SwitchProgress.CLAIMED
            # A switch that was posted between two cycles counts from the cycle before.
            if pending.time is None:
                pending.time = time - period
            if pending.request.ticket is not None:
                pending.request.ticket.accept()
            transaction = self.transaction = SwitchTransaction(self.lifecycle, pending)
        with self.changes:
            if not transaction.advance(time):
                return
            if pending.request.zero_period:
                # Update the started controllers with a period of zero.
                for one in dict.fromkeys(pending.start):
                    if one.controller.state is _RUNNING and one.fresh:
                        self.update_controller(one, time, 0.0)
            self._finish(pending)

    def _finish(self, pending: PendingSwitch) -> None:
        self.pending = None
        self.transaction = None
        pending.finish(self.cycle)


def milliseconds(duration: float) -> str:
    """Return a duration [s] in milliseconds, with three digits and no exponent.

    Args:
        duration: The duration [s].
    """
    number = 1000.0 * duration
    return f"{number:.0f} ms" if number >= 99.95 else f"{number:.3g} ms"
