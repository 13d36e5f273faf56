"""The control thread's half of the controller manager: update, switch, contain faults.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp, update,
manageSwitch, startControllers, startControllersAsap; differs: nothing a controller does
ends the update (CM-80); a strict switch in which a controller fails is taken back.
"""

import threading
from time import perf_counter

from station.core.control.controller import ControllerSample, ControllerState
from station.core.control.controller_lifecycle import ControllerLifecycle
from station.core.control.loaded_controller import LoadedController
from station.core.control.pending_switch import PendingSwitch, SwitchProgress, refused
from station.core.control.switching import Strictness
from station.core.errors import StationError, SwitchRefusedError
from station.core.faults import CONTAINED, reason_of, trace_of_fault
from station.core.hardware.robot_hw import RobotHW, SwitchState

_RUNNING = ControllerState.RUNNING


class ControllerRunner(ControllerLifecycle):
    """Runs the loaded controllers; every method is for the control thread.

    It never waits: callers swap `loaded` and put a switch into `pending`, the control
    thread looks at both once a cycle.

    Args:
        hw: The robot.

    Attributes:
        pending: The switch that is under way; None when there is none.
        cycle: Number of updates so far.
        time: Station time of the last update [s].
        thread: Identity of the thread of the last update.
        updating: An update is under way.
        interrupted: Names of the controllers that were stopped because the robot did
            not carry out their commands, the last time that happened.
    """

    def __init__(self, hw: RobotHW) -> None:
        super().__init__(hw)
        self.pending: PendingSwitch | None = None
        self.cycle = 0
        self.time = 0.0
        self.thread = 0
        self.updating = False
        self.interrupted: tuple[str, ...] = ()

    def update(self, time: float, period: float, *, reset_controllers: bool) -> None:
        """Update all running controllers, then carry on with a pending switch.

        Args:
            time: Station time [s].
            period: Time since the last cycle [s], >= 0.
            reset_controllers: Stop and start every running controller first (CM-78).
        """
        self.thread = threading.get_ident()
        self.updating = True
        self.cycle += 1
        self.time = time
        try:
            loaded = self.loaded
            if self.hw.is_interrupted():
                self._stop_interrupted(time)
            if reset_controllers:
                for one in loaded:
                    self.reset(one, time)
            for one in loaded:
                if one.controller.state is _RUNNING:
                    self._update_one(one, time, period)
            if self.pending is not None:
                self._carry_on(self.pending, time, period)
        finally:
            self.updating = False

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
        self.thread = threading.get_ident()
        self.updating = True
        self.cycle += 1
        self.time = time
        try:
            self._carry_on(pending, time, 0.0)
        finally:
            self.updating = False
        return True

    def _update_one(self, one: LoadedController, time: float, period: float) -> None:
        begin = perf_counter()
        try:
            one.controller.update(time, period)
            finite = one.is_finite()
        except CONTAINED as error:  # contained, kept and shown
            self.fail(one, time, reason_of("update", error), trace_of_fault())
            self.fall_back(one, time)
            return
        duration = perf_counter() - begin
        one.account(duration)
        if duration > period > 0.0:
            one.overruns += 1
            one.last_overrun = time
        if not finite:
            self.fail(one, time, f"update wrote the {one.bad_command()}", "")
            self.fall_back(one, time)
        elif one.fresh:
            self.check_first_update(one, time)

    def _stop_interrupted(self, time: float) -> None:
        """Stop the controllers whose commands the robot does not carry out."""
        found: list[LoadedController] = []
        for one in self.loaded:
            reason = ""
            if one.controller.state is _RUNNING:
                reason = self.hw.interruption_of(one.info)
            if reason:
                found.append(one)
                one.abort_goals(f"The robot ended the motion: {reason}.")
                self.stop(one, time)
                one.fault = one.fault or reason
                one.write_rest()
        if found:
            self.interrupted = tuple(one.info.name for one in found)
            self.do_switch([], [one.info for one in found])

    def stop_all(self, time: float) -> None:
        """Stop every controller, rest the robot, and end a switch that is under way.

        Args:
            time: Station time [s].
        """
        pending = self.pending
        waiting = [] if pending is None else self._end(pending, time)
        running = [one for one in self.loaded if one.controller.state is _RUNNING]
        for one in running:
            self.stop(one, time)
            one.write_rest()
        if running or waiting:
            self.do_switch([], [one.info for one in (*running, *waiting)])

    def _end(self, pending: PendingSwitch, time: float) -> list[LoadedController]:
        """End a switch under way; return the controllers that waited for it.

        Nothing happens when its caller has withdrawn it already.
        """
        posted = pending.progress is SwitchProgress.POSTED
        if posted and not pending.claim.acquire(blocking=False):
            return []
        waiting = [
            one
            for one in dict.fromkeys(pending.start)
            if one.controller.state is ControllerState.WAITING
        ]
        for one in waiting:
            self.abort(one, time, "everything was stopped")
        pending.error = SwitchRefusedError(
            "Everything was stopped before the switch was finished.",
            remedy="Release the stop, look at the state, and switch again.",
        )
        self._finish(pending)
        return waiting

    def void_commands(self, reason: str) -> None:
        """Void every set-point that has not been picked up, and every goal.

        Args:
            reason: Why, one sentence; the goals that end say it.
        """
        for one in self.loaded:
            controller = one.controller
            if controller.set_points is not None:
                controller.set_points.clear()
            if controller.goals is not None:
                controller.goals.void(reason)

    def samples(self) -> dict[str, ControllerSample]:
        """Return what each running controller did last, by name."""
        return {
            one.info.name: one.controller.sample
            for one in self.loaded
            if one.controller.sample is not None and one.controller.state is _RUNNING
        }

    def running_names(self) -> list[str]:
        """Return the names of the running controllers; any thread."""
        return [o.info.name for o in self.loaded if o.controller.state is _RUNNING]

    # One cycle of a switch

    def _carry_on(self, pending: PendingSwitch, time: float, period: float) -> None:
        if pending.progress is SwitchProgress.POSTED:
            if not pending.claim.acquire(blocking=False):
                return  # withdrawn by its caller
            pending.progress = SwitchProgress.RUNNING
            if pending.time is None:
                pending.time = time - period
            if not self._begin(pending, time):
                self._finish(pending)
                return
        if pending.request.start_asap:
            finished = self._start_asap(pending, time)
        else:
            finished = self._start_together(pending, time)
        if finished:
            if pending.expired:
                self._release(pending)
            if pending.request.zero_period:
                self._update_started(pending, time)
            self._finish(pending)

    def _update_started(self, pending: PendingSwitch, time: float) -> None:
        """Update what was started, without any time having passed."""
        for one in dict.fromkeys(pending.start):
            if one.controller.state is _RUNNING and one.fresh:
                self._update_one(one, time, 0.0)

    def _release(self, pending: PendingSwitch) -> None:
        """Take controllers off the hardware that were given up after their caller."""
        given_up = [
            one.info
            for one in dict.fromkeys(pending.start)
            if one.controller.state is ControllerState.ABORTED
        ]
        if given_up:
            self.do_switch([], given_up)

    def _finish(self, pending: PendingSwitch) -> None:
        self.pending = None
        pending.finish(self.cycle)

    def _begin(self, pending: PendingSwitch, time: float) -> bool:
        """Switch the hardware and stop controllers; return False when refused."""
        plan = pending.plan
        try:
            if self.start_gate is not None and pending.start:
                self.start_gate()
        except StationError as error:
            pending.error = error
            return False
        problem = self.do_switch(plan.start, plan.stop)
        for one in pending.stop:
            if one.controller.state is _RUNNING:
                self.stop(one, time)
        if problem:
            for one in pending.start:
                self.abort(one, time, problem)
                pending.failed[one.info.name] = problem
        return not problem

    def _start_together(self, pending: PendingSwitch, time: float) -> bool:
        # Asked twice unless it is done, as upstream does: CM-64, CM-65.
        hw = self.hw
        try:
            if hw.switch_result() is SwitchState.DONE:
                self._start_all(pending, time)
                return True
            failed = hw.switch_result() is SwitchState.ERROR
            problem = "the hardware could not switch" if failed else ""
        except CONTAINED as error:  # shown in the result
            problem = reason_of("switch_result", error)
        problem = problem or pending.lateness(time)
        for one in pending.start:
            self._wait_or_abort(pending, one, time, problem)
        return bool(problem)

    def _start_asap(self, pending: PendingSwitch, time: float) -> bool:
        finished = True
        for one in pending.start:
            if one.controller.state is not _RUNNING:
                self._start_when_ready(pending, one, time)
            finished = finished and one.controller.state is not ControllerState.WAITING
        return finished

    def _start_when_ready(
        self, pending: PendingSwitch, one: LoadedController, time: float
    ) -> None:
        # An aborted one is asked again while others wait, and may still start: CM-71.
        name, info = one.info.name, one.info
        if name in pending.given_up:
            return
        try:
            if self.hw.switch_result_for(info) is SwitchState.DONE:
                problem = self.start(one, time, pending.plan.stop, pending.jump)
                pending.note_start(name, problem)
                if problem:
                    self.fall_back(one, time)
                return
            failed = self.hw.switch_result_for(info) is SwitchState.ERROR
            problem = "the hardware could not switch" if failed else ""
        except CONTAINED as error:  # shown in the result
            problem = reason_of("switch_result_for", error)
        problem = problem or pending.lateness(time)
        self._wait_or_abort(pending, one, time, problem)

    def _wait_or_abort(
        self, pending: PendingSwitch, one: LoadedController, time: float, problem: str
    ) -> None:
        name = one.info.name
        if problem and name not in pending.given_up:
            self.abort(one, time, problem)
            pending.failed[name] = problem
        elif name not in pending.given_up:
            failure = self.wait(one, time)
            if failure:
                pending.note_start(name, failure)

    def _start_all(self, pending: PendingSwitch, time: float) -> None:
        strict = pending.request.strictness is Strictness.STRICT
        begun: list[LoadedController] = []
        for one in pending.start:
            name = one.info.name
            if name in pending.given_up:
                continue
            problem = self.start(one, time, pending.plan.stop, pending.jump)
            pending.note_start(name, problem)
            if not problem:
                begun.append(one)
            elif one.controller.state is ControllerState.CONSTRUCTED:
                continue  # CM-30: listed, and never started
            elif strict:
                pending.error = refused(name, problem, pending)
                self._take_back(pending, begun, time)
                return
            else:
                self.fall_back(one, time)

    def _take_back(
        self, pending: PendingSwitch, begun: list[LoadedController], time: float
    ) -> None:
        """Stop what was started and start again what was stopped, in this cycle."""
        plan = pending.plan
        for one in begun:
            if one.controller.state is _RUNNING:
                self.stop(one, time)
                one.write_rest()
        self.do_switch(plan.stop, list(dict.fromkeys(one.info for one in begun)))
        for one in pending.stop:
            if one.controller.state is _RUNNING or one.info not in plan.stop:
                continue  # named twice, or it did not run before
            problem = self.start_at_once(one, time, plan.start)
            if problem and pending.error is not None:
                pending.error.message += (
                    f" '{one.info.name}' could not be started again: "
                    f"{problem.rstrip('.')}."
                )
