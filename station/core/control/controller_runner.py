"""The control thread's half of the controller manager: update, switch, contain faults.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp, update;
differs: nothing that a controller does ends the update (CM-80).
"""

from threading import get_ident

from typing_extensions import override

from station.core.control.controller import ControllerState
from station.core.control.controller_lifecycle import ControllerLifecycle
from station.core.control.controller_round import ControllerRound
from station.core.control.loaded_controller import LoadedController
from station.core.control.pending_switch import PendingSwitch, SwitchProgress
from station.core.control.switch_transaction import SwitchTransaction
from station.core.errors import (
    ControllerNotFoundError,
    SwitchRefusedError,
    suggest,
)
from station.core.faults import CONTAINED, reason_of, trace_of_fault
from station.core.hardware.robot_hw import RobotHW, watch_of

_RUNNING = ControllerState.RUNNING

LATE_UPDATES = 100
"""After so many updates in a row over the budget a controller is stopped. A single one
may be the machine's doing: another process had the processor."""
LONGEST_UPDATE = 0.25
"""After two updates as long as this, the second within `STALL_MEMORY` of the first, a
controller is stopped [s]. A single one may be the machine's doing as well: the thread
that has the interpreter lock may be kept off the processor for so long."""
STALL_MEMORY = 10.0
"""How long the first of these counts [s station time]."""


class StateChanges:
    """Marks when the control thread changes who runs, for readers in other threads.

    Nobody waits for a lock: a reader looks whether a change has begun or ended while it
    read, and reads again. Entered for a change, also within one.

    Attributes:
        count: Odd during a change; another number after each.
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


class ControllerRunner(ControllerRound):
    """Runs the loaded controllers; every method is for the control thread.

    It never waits: callers swap `lifecycle.loaded` and put a switch into `pending`, the
    control thread looks at both once a cycle.

    Args:
        hw: The robot.

    Attributes:
        lifecycle: Starts and stops the controllers, and has the list of them.
        interrupted: Names of the controllers that were stopped because the robot did
            not carry out their commands, the last time that happened.
        changes: When it changes who runs.
    """

    def __init__(self, hw: RobotHW) -> None:
        self.lifecycle = ControllerLifecycle(hw)
        super().__init__(self.lifecycle.gate, watch_of(hw), _RUNNING, CONTAINED)
        self.interrupted: tuple[str, ...] = ()
        self.changes = StateChanges()
        self._hw = hw
        self._transaction: SwitchTransaction | None = None

    @property
    def loaded(self) -> tuple[LoadedController, ...]:
        """All loaded controllers in load order; replaced as a whole."""
        return self.lifecycle.loaded

    @loaded.setter
    def loaded(self, loaded: tuple[LoadedController, ...]) -> None:
        self.lifecycle.loaded = loaded

    def find(self, name: str) -> LoadedController:
        """Return the controller loaded as `name`. Any thread.

        Raises:
            ControllerNotFoundError: None of that name is loaded.
        """
        for loaded in self.lifecycle.loaded:
            if loaded.info.name == name:
                return loaded
        raise ControllerNotFoundError(
            f"No controller '{name}' is loaded.",
            remedy=suggest(name, (one.info.name for one in self.lifecycle.loaded)),
            details={"controller": name},
        )

    @override
    def refuse(self, time: float, period: float) -> None:
        self.resets = False  # a cycle that is refused changes nothing
        raise ValueError(
            f"Cannot update at time {time} s after a period of {period} s: both "
            "must be finite and not negative."
        )

    @override
    def look_closely(self, time: float, period: float) -> None:
        """Do a cycle with a switch, an interruption, a trace or a restart in it."""
        with self.changes:
            self._look_closely(time, period)

    def _look_closely(self, time: float, period: float) -> None:
        gate, loaded = self.lifecycle.gate, self.lifecycle.loaded
        if gate.traced_cycles:
            gate.restore()
        if self._hw.is_interrupted():
            self._stop_interrupted(time)
        if self.resets:
            self.resets = False
            gate.forget_rest()
            for one in loaded:
                self.lifecycle.reset(one, time)
        for one in loaded if gate.is_stale else gate.running:
            if one.controller.state is _RUNNING:
                self._update_closely(one, time, period)
                if gate.is_stale:
                    self._update_after(one, loaded, time, period)
                    break
        self._close(time, period)

    @override
    def go_on_after(self, one: LoadedController, time: float, period: float) -> None:
        """Do the rest of a cycle in which a controller has failed.

        Another one may have taken over.
        """
        with self.changes:
            self._update_after(one, self.lifecycle.loaded, time, period)
            self._close(time, period)

    def _close(self, time: float, period: float) -> None:
        """Carry on with a pending switch, and note who owns which commands."""
        gate = self.lifecycle.gate
        if self.pending is not None:
            gate.restore()
            self._carry_on(self.pending, time, period)
        gate.close(self.lifecycle.loaded)
        self._note_running()

    def _note_running(self) -> None:
        self.kept = self.lifecycle.gate.kept
        self.take_turns([one.turn() for one in self.lifecycle.gate.running])

    def _update_after(
        self,
        last: LoadedController,
        loaded: tuple[LoadedController, ...],
        time: float,
        period: float,
    ) -> None:
        """Update those that run and were loaded after `last`."""
        for one in loaded[loaded.index(last) + 1 :]:
            if one.controller.state is _RUNNING:
                self._update_closely(one, time, period)

    def carry_on_switch(self, time: float) -> bool:
        """Carry on with a pending switch while time stands still.

        Args:
            time: Station time [s].

        Returns:
            Whether there was one.
        """
        pending = self.pending
        if pending is None:
            return False
        self.thread = get_ident()
        self.updating = True
        self.cycle += 1
        self.time = time
        try:
            with self.changes:
                self._carry_on(pending, time, 0.0)
                self.lifecycle.gate.close(self.lifecycle.loaded)
                self._note_running()
        finally:
            self.updating = False
        return True

    def _update_closely(
        self, one: LoadedController, time: float, period: float
    ) -> None:
        self.update_one(one.turn(), time, period)
        if self.lifecycle.gate.traced_cycles:
            intrusion = self.lifecycle.gate.find_intrusion(one, self.lifecycle.loaded)
            if intrusion is not None:
                problem = f"update wrote {intrusion}, which it has not claimed"
                self._fail(one, time, problem, None)

    @override
    def fail(self, one: LoadedController, time: float, error: BaseException) -> None:
        """Take a controller off the robot whose update has raised; shown by status."""
        self._fail(one, time, reason_of("update", error), trace_of_fault())

    @override
    def attend(
        self, one: LoadedController, time: float, duration: float, is_finite: bool
    ) -> None:
        refused = None if is_finite else one.commands.refused()
        if refused is not None:
            self._fail(one, time, f"update wrote the {refused}", None)
        elif one.fresh:
            self.lifecycle.check_first_update(one, time)
        if duration > self.update_budget or one.late_updates:
            self._judge_duration(one, time, duration)

    def _fail(
        self, one: LoadedController, time: float, problem: str, trace: str | None
    ) -> None:
        with self.changes:
            self.lifecycle.fail(one, time, problem, trace)
            self.lifecycle.fall_back(one, time)

    def _judge_duration(
        self, one: LoadedController, time: float, duration: float
    ) -> None:
        """Stop a controller whose updates keep taking longer than the budget."""
        if duration <= self.update_budget or one.controller.state is not _RUNNING:
            one.late_updates = 0
            return
        one.late_updates += 1
        is_stalled_again = False
        if duration >= LONGEST_UPDATE:
            is_stalled_again = time - one.stalled_at <= STALL_MEMORY
            one.stalled_at = time
        if one.late_updates >= LATE_UPDATES:
            times = f"{LATE_UPDATES} in a row"
        elif is_stalled_again:
            times = f"and one within {STALL_MEMORY:g} s before it as long"
        else:
            return
        self._fail(
            one,
            time,
            f"update took {milliseconds(duration)}, {times}; an update may take at "
            f"most {milliseconds(self.update_budget)}",
            None,
        )

    def _stop_interrupted(self, time: float) -> None:
        """Stop the controllers whose commands the robot does not carry out."""
        found: list[LoadedController] = []
        for one in self.lifecycle.loaded:
            reason: str | None = None
            if one.controller.state is _RUNNING:
                reason = self._hw.interruption_of(one.info)
            if reason:
                found.append(one)
                one.abort_goals(f"The robot ended the motion: {reason}.")
                self.lifecycle.stop(one, time)
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
            involved = [] if pending is None else self._end(pending, time)
            running = [one for one in self.lifecycle.loaded if _is_running(one)]
            for one in running:
                self.lifecycle.stop(one, time)
                one.commands.write_rest()
            if running or involved:
                self.lifecycle.release(list(dict.fromkeys((*running, *involved))))

    def _end(self, pending: PendingSwitch, time: float) -> list[LoadedController]:
        """End a switch under way; return the controllers that it was about.

        Nothing happens when its caller has withdrawn it already.
        """
        if pending.progress is SwitchProgress.POSTED:
            if not pending.claim.acquire(blocking=False):
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

    def void_commands(self, reason: str) -> None:
        """Void every set-point that has not been picked up, and every goal.

        Args:
            reason: Why, one sentence; the goals that end say it.
        """
        for one in self.lifecycle.loaded:
            controller = one.controller
            if controller.set_points is not None:
                controller.set_points.clear()
            if controller.goals is not None:
                controller.goals.void(reason)

    def running_names(self) -> list[str]:
        """Return the names of the running controllers. Any thread."""
        return [one.info.name for one in self.lifecycle.loaded if _is_running(one)]

    def _carry_on(self, pending: PendingSwitch, time: float, period: float) -> None:
        transaction = self._transaction
        if pending.progress is SwitchProgress.POSTED or transaction is None:
            if not pending.claim.acquire(blocking=False):
                return  # withdrawn by its caller
            pending.progress = SwitchProgress.CLAIMED
            if pending.time is None:
                pending.time = time - period
            if pending.request.receipt is not None:
                pending.request.receipt.pick_up()
            transaction = self._transaction = SwitchTransaction(self.lifecycle, pending)
        if transaction.carry_on(time):
            if pending.request.zero_period:
                self._update_started(pending, time)
            self._finish(pending)

    def _update_started(self, pending: PendingSwitch, time: float) -> None:
        """Update what was started, without any time having passed."""
        for one in dict.fromkeys(pending.start):
            if one.controller.state is _RUNNING and one.fresh:
                self._update_closely(one, time, 0.0)

    def _finish(self, pending: PendingSwitch) -> None:
        self.pending = None
        self._transaction = None
        pending.finish(self.cycle)


def milliseconds(duration: float) -> str:
    """Return a duration [s] in milliseconds, of three digits and never as a power.

    Args:
        duration: The duration [s].
    """
    number = 1000.0 * duration
    return f"{number:.0f} ms" if number >= 99.95 else f"{number:.3g} ms"


def _is_running(one: LoadedController) -> bool:
    return one.controller.state is _RUNNING
