"""One switch in the control thread: committed, rolled back, or halted.

    posted ── start gate ──▶ refused                          nothing has changed
       │
    do_switch(start, stop)
       │ raises ─▶ do_switch(stop, start) ─▶ rolled back: those that ran run on
       ▼
    stop those to be stopped
       ▼
    switch_result each cycle ─ DONE ─▶ start ─▶ committed
       │ ERROR, raises, too late, or (strict) a start fails
       ▼
    strict: stop what was started, do_switch(stop, start)
       ▼
    switch_result each cycle ─ DONE ─▶ start those that ran ─▶ rolled back
       │ ERROR, raises, more than `ROLLBACK_CYCLES`, or a start fails
       ▼
    halted: all controllers in the switch are stopped, do_switch([], all of them); the
    result says so, and names the controllers that the robot has not confirmed.

With best effort, and with `start_asap`, a controller that cannot be started is taken
off the hardware by itself and the others stay: the switch is committed in part.

A switch that only stops is never rolled back, because its caller does not want the
controllers to run again: they stop and their resources rest whatever the hardware says.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp, manageSwitch,
startControllers, startControllersAsap; differs: see
`station/testing/recorded/deliberate_differences.py`, CM-60 to CM-75.
"""

from collections.abc import Callable, Sequence

from station.core.control.chains import depth_of
from station.core.control.controller import ControllerState
from station.core.control.controller_lifecycle import ControllerLifecycle
from station.core.control.loaded_controller import LoadedController
from station.core.control.pending_switch import (
    PendingSwitch,
    SwitchOutcome,
    SwitchProgress,
    refused,
)
from station.core.control.switching import Strictness
from station.core.errors import CONTAINED, StationError, SwitchRefusedError, reason_of
from station.core.hardware.robot_hw import ControllerInfo, SwitchState

_RUNNING = ControllerState.RUNNING

ROLLBACK_CYCLES = 2000
"""Number of cycles in which the hardware must take a switch back. A Franka that has to
come to rest before it changes its mode needs a few hundred."""


class SwitchTransaction:
    """Advances one pending switch, cycle by cycle. Control thread only.

    Args:
        lifecycle: Starts and stops the controllers.
        pending: The switch.
    """

    def __init__(self, lifecycle: ControllerLifecycle, pending: PendingSwitch) -> None:
        self._lifecycle = lifecycle
        self._hw = lifecycle.hw
        self._pending = pending
        self._cycles_left = ROLLBACK_CYCLES
        self._was_running: list[LoadedController] = []
        self._begun: set[str] = set()  # names started as soon as possible

    def advance(self, time: float) -> bool:
        """Advance the switch by a cycle; return whether it is finished.

        Args:
            time: Station time [s].
        """
        self._lifecycle.promised = self._promised
        is_finished = self._advance(time)
        if is_finished:
            self._lifecycle.promised = tuple
        return is_finished

    def _promised(self) -> list[LoadedController]:
        pending = self._pending
        if pending.progress is SwitchProgress.ROLLING_BACK:
            return self._was_running
        settled = self._begun | pending.given_up
        return [one for one in _once(pending.start) if one.info.name not in settled]

    def _advance(self, time: float) -> bool:
        pending = self._pending
        if pending.progress is SwitchProgress.ROLLING_BACK:
            return self._advance_rollback(time)
        if pending.progress is SwitchProgress.CLAIMED:
            pending.progress = SwitchProgress.RUNNING
            finished = self._begin(time)
            if finished is not None:
                return finished
        if pending.request.start_asap:
            return self._start_asap(time)
        return self._start_together(time)

    def _begin(self, time: float) -> bool | None:
        """Switch the hardware and stop controllers.

        Returns:
            Whether the switch is finished; None when it goes on with the starts.
        """
        pending, plan = self._pending, self._pending.plan
        try:
            if self._lifecycle.start_gate is not None and pending.start:
                self._lifecycle.start_gate()
        except StationError as error:
            pending.error = error
            return True
        self._was_running = [
            one for one in _once(pending.stop) if one.controller.state is _RUNNING
        ]
        problem = self._lifecycle.do_switch(plan.start, plan.stop)
        if problem is not None and pending.start:
            return self._take_back_at_once(time, problem)
        for one in pending.stop:
            if one.controller.state is _RUNNING:
                self._lifecycle.stop(one, time)
        if problem is not None:
            self._keep_unreleased(problem)
            return True
        for one in pending.stop:
            one.is_unreleased = False
        return None

    def _start_together(self, time: float) -> bool:
        # Up to two questions until it is done, as upstream asks: CM-64, CM-65.
        done, problem = self._ask(self._hw.switch_result, "switch_result")
        if done:
            return self._start_all(time)
        problem = problem or self._pending.lateness(time)
        if problem is None:
            for one in self._pending.start:
                self._wait(one, time)
            return False
        return self._give_up(time, problem)

    def _give_up(self, time: float, problem: str) -> bool:
        """End a switch that the hardware did not carry out."""
        pending = self._pending
        for one in _once(pending.start):
            name, runs = one.info.name, one.controller.state is _RUNNING
            # With best effort the request may name a controller that runs already.
            if name not in pending.given_up and not runs:
                self._lifecycle.abort(one, time, problem)
                pending.failed[name] = problem
        if not pending.start:
            self._keep_unreleased(problem)
            return True
        if self._is_strict and self._was_running:
            return self._roll_back([], time)
        self._release_failed(self._was_running)
        return True

    def _start_all(self, time: float) -> bool:
        pending = self._pending
        begun: list[LoadedController] = []
        for one in pending.start:
            name = one.info.name
            if name in pending.given_up:
                continue
            problem = self._lifecycle.start(one, time, pending.plan.stop, pending.jump)
            pending.note_start(name, problem)
            if problem is None:
                begun.append(one)
            elif one.controller.state is ControllerState.CONSTRUCTED:
                continue  # CM-30: listed, and never started
            elif self._is_strict:
                pending.error = refused(name, problem, pending)
                return self._roll_back(begun, time)
            else:
                self._lifecycle.fall_back(one, time)
        return True

    def _start_asap(self, time: float) -> bool:
        pending = self._pending
        for one in pending.start:
            if one.controller.state is not _RUNNING:
                self._start_when_ready(one, time)
        if any(o.controller.state is ControllerState.WAITING for o in pending.start):
            return False
        self._release_failed([])
        return True

    def _start_when_ready(self, one: LoadedController, time: float) -> None:
        # An aborted controller is asked again while others wait: CM-71.
        pending, name = self._pending, one.info.name
        if name in pending.given_up:
            return
        if name in self._begun:
            # The controller has failed since its start, and the hardware knows.
            pending.note_start(name, one.fault or "it was stopped after its start")
            return
        done, problem = self._ask(
            lambda: self._hw.switch_result_for(one.info), "switch_result_for"
        )
        following = one.missing_following()
        if done and following is not None:
            # It waits for its following controller as it waits for the hardware.
            done = following.controller.state is not ControllerState.WAITING
        if done:
            failure = self._lifecycle.start(one, time, pending.plan.stop, pending.jump)
            pending.note_start(name, failure)
            if failure is None:
                self._begun.add(name)
            else:
                self._lifecycle.fall_back(one, time)
            return
        problem = problem or pending.lateness(time)
        if problem is None:
            self._wait(one, time)
        else:
            self._lifecycle.abort(one, time, problem)
            pending.failed[name] = problem

    def _wait(self, one: LoadedController, time: float) -> None:
        pending, name = self._pending, one.info.name
        if name not in pending.given_up:
            failure = self._lifecycle.wait(one, time)
            if failure is not None:
                pending.note_start(name, failure)

    def _release_failed(self, stopped: list[LoadedController]) -> None:
        """Take the controllers that could not be started off the hardware.

        Args:
            stopped: Controllers whose stop the hardware has not confirmed either.
        """
        failed = [
            *stopped,
            *(
                one
                for one in _once(self._pending.start)
                if one.controller.state is ControllerState.ABORTED
            ),
        ]
        if failed and self._lifecycle.release(failed) is not None:
            for one in failed:
                self._pending.failed[one.info.name] = str(one.fault)

    def _keep_unreleased(self, problem: str) -> None:
        """End a switch that only stops and that the hardware did not carry out."""
        if not self._pending.stop:
            # No controller is in the switch, so `failed` cannot give the reason.
            self._pending.error = SwitchRefusedError(
                "The robot did not carry out a switch that starts and stops nothing: "
                f"{problem}.",
                remedy="Look at the robot; the controllers are as before.",
            )
            return
        for one in _once(self._pending.stop):
            one.is_unreleased = True
            one.add_fault(f"the robot may still be in its mode: {problem}")
            self._pending.failed[one.info.name] = (
                "it has stopped and its resources rest, but the robot may still be in "
                f"its mode: {problem}"
            )
        self._pending.outcome = SwitchOutcome.HALTED

    # Taking back

    def _take_back_at_once(self, time: float, problem: str) -> bool:
        """Undo a `do_switch` that raised, before anything was stopped."""
        pending, plan = self._pending, self._pending.plan
        for one in _once(pending.start):
            if one.controller.state is not _RUNNING:
                self._lifecycle.abort(one, time, problem)
                pending.failed[one.info.name] = problem
        undone = self._lifecycle.do_switch(self._restored, plan.start)
        done, _ = self._ask(self._hw.switch_result, "switch_result")
        if undone is None and done:
            # The controllers to be stopped still run, and have not noticed.
            self._end_rolled_back()
            return True
        for one in self._was_running:
            self._lifecycle.stop(one, time)
        if undone is not None:
            return self._halt(time, undone)
        pending.progress = SwitchProgress.ROLLING_BACK
        return False

    @property
    def _restored(self) -> list[ControllerInfo]:
        """Return the controllers to restore; one that has failed stays off."""
        ran = {one.info.name for one in self._was_running}
        return [info for info in self._pending.plan.stop if info.name in ran]

    def _roll_back(self, begun: list[LoadedController], time: float) -> bool:
        """Stop the started controllers, and begin to restart the stopped ones."""
        plan = self._pending.plan
        # Preceding controllers stop before their following ones.
        for one in reversed(begun) if self._lifecycle.has_chains else begun:
            if one.controller.state is _RUNNING:
                self._lifecycle.stop(one, time)
                one.commands.write_rest()
        for one in self._pending.start:
            if one.controller.state is ControllerState.WAITING:
                self._lifecycle.abort(one, time, "the switch was taken back")
        problem = self._lifecycle.do_switch(self._restored, plan.start)
        if problem is not None:
            return self._halt(time, problem)
        self._pending.progress = SwitchProgress.ROLLING_BACK
        return self._advance_rollback(time)

    def _advance_rollback(self, time: float) -> bool:
        done, problem = self._ask(self._hw.switch_result, "switch_result")
        if done:
            return self._start_again(time)
        self._cycles_left -= 1
        if problem is None and self._cycles_left > 0:
            return False
        return self._halt(time, problem or "the hardware did not get ready again")

    def _start_again(self, time: float) -> bool:
        pending = self._pending
        self._end_rolled_back()
        # Following controllers start before their preceding ones.
        for one in sorted(self._was_running, key=depth_of):
            if one.controller.state is _RUNNING:
                continue
            problem = self._lifecycle.start(one, time, pending.plan.start, {})
            if problem is not None:
                pending.outcome = SwitchOutcome.HALTED
                pending.not_restored[one.info.name] = problem
        return True

    def _end_rolled_back(self) -> None:
        """Report that all is as before, except for controllers that failed earlier."""
        pending = self._pending
        pending.outcome = SwitchOutcome.ROLLED_BACK
        for one in _once(pending.stop):
            if one not in self._was_running:
                reason = one.fault or "it did not run any more when the switch began"
                pending.not_restored[one.info.name] = reason

    def _halt(self, time: float, problem: str) -> bool:
        """Take all controllers in the switch off the hardware: the safe state."""
        pending = self._pending
        pending.outcome = SwitchOutcome.HALTED
        for one in self._was_running:
            if one.controller.state is _RUNNING:
                self._lifecycle.stop(one, time)
            one.fault = None
            self._lifecycle.abort(one, time, f"it could not be restored: {problem}")
            pending.not_restored[one.info.name] = problem
        self._lifecycle.release([*_once(pending.start), *self._was_running])
        return True

    @property
    def _is_strict(self) -> bool:
        return self._pending.request.strictness is not Strictness.BEST_EFFORT

    def _ask(
        self, question: Callable[[], SwitchState], name: str
    ) -> tuple[bool, str | None]:
        """Ask the hardware whether it is done; return the answer and its failure."""
        try:
            if question() is SwitchState.DONE:
                return True, None
            failed = question() is SwitchState.ERROR
        except CONTAINED as error:  # shown in the result
            return False, reason_of(name, error)
        return False, "the hardware could not switch" if failed else None


def _once(controllers: Sequence[LoadedController]) -> list[LoadedController]:
    """Return the controllers without repetitions (CM-51), in their order."""
    return list(dict.fromkeys(controllers))
