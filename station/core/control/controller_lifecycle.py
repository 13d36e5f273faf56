"""Starting, stopping and aborting one controller, with every fault contained.

Source: ros_control@0.20.0 controller_interface/controller_base.h; differs: after an
exception, or a command that is not a real finite number, only that controller is taken
off the robot, in the same cycle (CM-80); the first command of a started controller is
checked for a jump; commands that a controller writes without owning them are put back.
"""

from collections.abc import Callable, Sequence
from math import isfinite

from station.core.control.chainable_controller import ChainableController
from station.core.control.chains import REFERENCES, find_conflicts
from station.core.control.command_gate import CommandGate
from station.core.control.controller import ControllerState
from station.core.control.hardware_components import HardwareComponents
from station.core.control.loaded_controller import LoadedController
from station.core.errors import (
    CONTAINED,
    ControllerNotFoundError,
    StationError,
    describe,
    printable,
    reason_of,
    suggest,
    trace_of_fault,
)
from station.core.hardware.robot_hw import ControllerInfo, RobotHW, SwitchState

_RUNNING = ControllerState.RUNNING


class ControllerLifecycle:
    """Starts, stops and aborts loaded controllers; for the control thread.

    Throughout, `time` is station time [s].

    Args:
        hw: The robot.

    Attributes:
        gate: Keeps the commands with their owners.
        components: The hardware components and their states; none is active before
            `begin`.
        loaded: All loaded controllers in load order; replaced as a whole.
        start_gate: Called before anything is started; raises a StationError when
            nothing may start. None when there is no such rule.
        promised: Returns the controllers that a switch in progress has still to start.
    """

    def __init__(self, hw: RobotHW) -> None:
        self.hw = hw
        self.gate = CommandGate(hw)
        self.components = HardwareComponents(hw)
        self.loaded: tuple[LoadedController, ...] = ()
        self.start_gate: Callable[[], None] | None = None
        self.promised: Callable[[], Sequence[LoadedController]] = tuple
        # Names of the failed controllers that a fallback stands in for, by its name.
        self._stands_for: dict[str, tuple[str, ...]] = {}

    @property
    def has_chains(self) -> bool:
        """True if a loaded controller commands another one, or reads its states."""
        return any(one.following or one.read for one in self.loaded)

    def find(self, name: str) -> LoadedController:
        """Return the controller loaded as `name`. Any thread.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
        """
        for one in self.loaded:
            if one.info.name == name:
                return one
        raise ControllerNotFoundError(
            f"No controller '{name}' is loaded.",
            remedy=suggest(name, (one.info.name for one in self.loaded)),
            details={"controller": name},
        )

    def void_commands(self, reason: str) -> None:
        """Void every set-point that has not been picked up, and every goal.

        Args:
            reason: Why, one sentence; the results of the goals contain it.
        """
        for one in self.loaded:
            controller = one.controller
            if controller.set_points is not None:
                controller.set_points.clear()
            if controller.goals is not None:
                controller.goals.void(reason)

    def start(
        self,
        one: LoadedController,
        time: float,
        stopped: tuple[ControllerInfo, ...],
        jump: dict[str, float],
    ) -> str | None:
        """Start one controller; return why that was not possible.

        Args:
            one: The controller; it may be running already (CM-48, CM-51).
            time: Station time [s].
            stopped: Controllers stopped in the same cycle; a command of a resource that
                one of them had, through the same interface, continues from the last
                command.
            jump: Receives the jump of the commands, by resource.
        """
        controller = one.controller
        self._stands_for.pop(one.info.name, None)
        if controller.state is ControllerState.CONSTRUCTED:
            return "it was never initialised"
        missing = one.missing_following()
        if missing is not None:
            reason = f"{_named(one, missing)} does not run"
            self.fail(one, time, reason, None)
            return reason
        # A restart takes over its own commands.
        own = (one.info,) if controller.state is _RUNNING else ()
        # Its following controllers run already: it continues from their references.
        references = {(REFERENCES, name) for name in one.info.references}
        unknown = one.commands.prepare(
            {claim for info in (*stopped, *own) for claim in _claims(info)} | references
        )
        if unknown is not None:
            self.fail(one, time, unknown, None)
            return unknown
        problem, trace = self._call_starting(one, time, jump)
        if problem is None and one.following:
            problem = self._chain(one, time)
        if problem is not None:
            one.commands.write_rest()  # what `starting` wrote must not reach the robot
            self.fail(one, time, problem, trace)
            # The references keep the values that they had before this start.
            one.commands.put_back_claims(references)
            return problem
        one.fault = one.traceback = None
        # The robot has just entered the mode of this controller.
        one.is_unreleased = False
        one.times.forget_late_updates()
        one.watch_first_update()
        self.gate.is_stale = True
        return None

    def _call_starting(
        self, one: LoadedController, time: float, jump: dict[str, float]
    ) -> tuple[str | None, str | None]:
        """Call `starting`; return its fault, if any, and its traceback."""
        problem, trace = self._call(one, "starting", one.controller.start_request, time)
        if problem is not None:
            return problem, trace
        refused = one.commands.refused()
        if refused is not None:
            return f"starting wrote the {refused}", None
        jump.update(one.commands.jumps())
        return one.excessive_jump(), None

    def _call(
        self,
        one: LoadedController,
        name: str,
        callback: Callable[[float], object],
        time: float,
    ) -> tuple[str | None, str | None]:
        """Call a controller; return the fault of the call, if any, and its traceback.

        Values that the call writes over commands of other controllers, or of resources
        without an owner, are put back at once: nothing else rewrites them in this
        cycle.
        """
        # A callback may write through any handle that it has kept.
        remembered = self.gate.remember(one)
        problem: str | None = None
        trace: str | None = None
        try:
            callback(time)
        except CONTAINED as error:  # contained, kept and shown
            problem, trace = reason_of(name, error), trace_of_fault()
        resource = self.gate.put_back(remembered)
        if problem is None and resource is not None:
            problem = (
                f"{name} wrote the command of '{resource}', which it has not claimed"
            )
        return problem, trace

    def start_at_once(
        self,
        one: LoadedController,
        time: float,
        stopped: tuple[ControllerInfo, ...],
    ) -> str | None:
        """Start one controller if the hardware is ready; return why it did not start.

        Args:
            one: The controller.
            time: Station time [s].
            stopped: As for `start`.
        """
        try:
            ready = self.hw.switch_result_for(one.info) is SwitchState.DONE
            problem = None if ready else "the hardware was not ready at once"
        except CONTAINED as error:  # kept and shown
            problem = reason_of("switch_result_for", error)
        if problem is not None:
            self.fail(one, time, problem, None)
            return problem
        return self.start(one, time, stopped, {})

    def check_first_update(self, one: LoadedController, time: float) -> None:
        """Check the command of the first update for a jump, as after `starting`."""
        one.fresh = False
        if self._is_to_move(one):
            return
        problem = one.excessive_jump()
        if problem is not None:
            self.fail_chain(one, time, problem, None)

    def _is_to_move(self, one: LoadedController) -> bool:
        """Return whether `one` or a controller that commands it got a set-point."""
        return one.got_set_point() or any(
            self._is_to_move(other)
            for other in self.loaded
            if one in other.following and other.controller.state is _RUNNING
        )

    def stop(self, one: LoadedController, time: float) -> None:
        """Stop one controller; an error of its `stopping` is kept as its fault.

        The last commands of `stopping`, e.g. of a brake, are kept: a successor in the
        same cycle continues from them. A command that is not a real finite number is
        replaced by the rest of its resource here, so that the successor is not blamed
        for it.
        """
        self.gate.is_stale = True
        problem, trace = self._call(one, "stopping", one.controller.stop_request, time)
        refused = one.commands.refused()
        if problem is None and refused is not None:
            problem = f"stopping wrote the {refused}"
        if problem is not None:
            one.controller.state = ControllerState.STOPPED
            one.fault, one.traceback = problem, trace
            one.abort_goals(f"The controller failed: {problem}.")
            one.commands.write_rest()

    def wait(self, one: LoadedController, time: float) -> str | None:
        """Call `waiting` while the hardware switches; return the failures."""
        self.gate.is_stale = True
        before = one.commands.values()
        problem, trace = self._call(one, "waiting", one.controller.wait_request, time)
        written = one.commands.put_back(before)
        if problem is None and written is not None:
            # A waiting controller owns no command yet; another one may own it.
            problem = f"waiting wrote the command {written}, which it does not own yet"
        if problem is not None:
            self.fail(one, time, problem, trace)
        return problem

    def abort(self, one: LoadedController, time: float, problem: str) -> None:
        """Mark one controller as not running because of `problem`.

        If the controller was running, its commands rest. Otherwise another controller
        may own them already, so they stay.
        """
        self.gate.is_stale = True
        if one.controller.state is _RUNNING:
            one.commands.write_rest()
        one.fault, one.traceback, one.fresh = problem, None, False
        one.abort_goals(f"The controller failed: {problem}.")
        before = one.commands.values()
        failure, trace = self._call(one, "aborting", one.controller.abort_request, time)
        if failure is not None:
            one.controller.state = ControllerState.ABORTED
            one.add_fault(failure)
            one.traceback = trace
        written = one.commands.put_back(before)
        if written is not None:
            one.add_fault(f"aborting wrote the command {written}, which was put back")

    def _chain(self, one: LoadedController, time: float) -> str | None:
        """Put the controllers that `one` commands into chained mode.

        Returns:
            Why one of them refuses the mode; None if all accept it.
        """
        for each in one.following:
            problem = self._set_chained_mode(each, time, chained_mode=True)
            if problem is not None:
                return f"'{each.info.name}' refuses chained mode: {problem}"
        return None

    def _set_chained_mode(
        self, one: LoadedController, time: float, *, chained_mode: bool
    ) -> str | None:
        """Change the mode of a controller if it differs; return why that is refused."""
        target = one.controller
        # A controller with references is chainable; this is for the type checker.
        if not isinstance(target, ChainableController):
            return None
        if target.is_in_chained_mode == chained_mode:
            return None
        accepted: list[bool] = []

        def change(_: float) -> None:
            accepted.append(target.set_chained_mode(chained_mode=chained_mode))

        problem, _ = self._call(one, "on_set_chained_mode", change, time)
        if problem is None and not accepted[0]:
            problem = "its on_set_chained_mode returned False"
        return problem

    def settle_chains(self, time: float) -> None:
        """End chains that have lost a controller; end chained mode without a commander.

        Called at the end of a cycle in which a controller has started or stopped, so
        that no preceding controller runs without its following ones when the commands
        are written. A preceding controller that replaces another one in the same cycle
        continues from that controller's references.
        """
        broken: list[LoadedController] = []
        # From the hardware upwards, and once more for those that read states: a chain
        # that ends may break the one above it.
        before = -1
        while before < len(broken):
            before = len(broken)
            for one in reversed(self.loaded):
                missing = one.missing_following()
                if missing is not None and one.controller.state is _RUNNING:
                    self.fail(one, time, _without(one, missing), None)
                    broken.append(one)
        for one in broken:
            self.fall_back(one, time)
        # From the far end: a controller that fails here stops commanding the next one.
        for one in self.loaded:
            if one.references and not self._is_commanded(one):
                self._end_chained_mode(one, time)

    def _is_commanded(self, one: LoadedController) -> bool:
        return any(
            one in other.following and other.controller.state is _RUNNING
            for other in self.loaded
        )

    def _end_chained_mode(self, one: LoadedController, time: float) -> None:
        """End chained mode without a commander, and let the references rest."""
        target = one.controller
        if not isinstance(target, ChainableController) or not target.is_in_chained_mode:
            return
        for reference in one.references:
            rest = reference.rest()
            # A robot that cannot read its state has no rest; the last one is kept.
            if isfinite(rest):
                reference.storage[reference.index] = rest
        problem = self._set_chained_mode(one, time, chained_mode=False)
        if problem is not None:
            # No controller commands it, so it cannot stay in this mode.
            target.is_in_chained_mode = False
            if target.state is _RUNNING:
                self.fail_chain(one, time, problem, None)

    def reset(self, one: LoadedController, time: float) -> None:
        """Stop and start one controller if it runs (CM-78)."""
        if one.controller.state is _RUNNING:
            self.stop(one, time)
            self.start(one, time, (one.info,), {})

    def fail(
        self, one: LoadedController, time: float, reason: str, trace: str | None
    ) -> None:
        """Take a failed controller off the robot in this cycle; it becomes aborted."""
        self.abort(one, time, reason)
        one.traceback = trace or one.traceback
        self.release([one])

    def fail_chain(
        self, one: LoadedController, time: float, reason: str, trace: str | None
    ) -> None:
        """Take a running controller that has failed and its chain off the robot.

        The chain are the running controllers that command it or that it commands, those
        that read its states, and so on. Then the fallback of each starts. A controller
        that it commands runs on if its fallback commands that controller, too.
        """
        fallback = [each for each in self.loaded if each.info.name in one.fallback]
        kept = {each.info.name for standby in fallback for each in _below(standby)}
        self.fail(one, time, reason, trace)
        ended = [one]
        for each in ended:
            for other in self.loaded:
                if other.controller.state is not _RUNNING:
                    continue
                needed = (*other.following, *other.read)
                problem = _without(other, each) if each in needed else None
                if other in each.following and other.info.name not in kept:
                    problem = f"'{each.info.name}', which commanded it, has failed: "
                    problem += f"{each.fault}"
                if problem is not None:
                    self.fail(other, time, problem, None)
                    ended.append(other)
        for each in ended:
            self.fall_back(each, time)

    def release(self, stopped: Sequence[LoadedController]) -> str | None:
        """Take stopped controllers off the hardware; return the failure, if any.

        If the call to the robot fails, the controllers are marked as not released: they
        can be stopped again, and cannot be unloaded before a stop has succeeded.
        """
        problem = self.do_switch([], [one.info for one in stopped])
        for one in stopped:
            one.is_unreleased = problem is not None
            if problem is not None:
                one.add_fault(f"the robot may still be in its mode: {problem}")
        return problem

    def fall_back(self, failed: LoadedController, time: float) -> None:
        """Start the fallback of `failed` in this cycle; without it the joints rest.

        A controller is not started as the fallback of a controller that stands in for
        it. Differs: ros2_control starts it again, so that two controllers that name
        each other and both fail take turns on the robot in every cycle.
        """
        replacements = self._replacements(failed)
        if not replacements:
            return
        problem = self.do_switch([one.info for one in replacements], [])
        if problem is not None:
            failed.add_fault(f"no fallback: {problem}")
            self.release(replacements)
            return
        for one in replacements:
            self._start_replacement(one, failed, time)

    def _replacements(self, failed: LoadedController) -> list[LoadedController]:
        """Return the fallback controllers of `failed`; none unless all can run now."""
        if not failed.fallback:
            return []
        known = {one.info.name: one for one in self.loaded}
        wanted = [known[name] for name in failed.fallback if name in known]
        running = [one.info for one in self.loaded if one.controller.state is _RUNNING]
        start = [one for one in wanted if one.controller.state is not _RUNNING]
        # The robot already expects these: no other controller takes their resources,
        # and only the switch starts them.
        promised = [
            one for one in self.promised() if one.controller.state is not _RUNNING
        ]
        reason: str | None = None
        try:
            if self.start_gate is not None:
                self.start_gate()
            conflicts = find_conflicts(
                self.hw,
                [*running, *(one.info for one in dict.fromkeys([*promised, *start]))],
            )
            refusals = [self.components.refusal(one.info) for one in start]
            reason = next((each for each in refusals if each), None)
            if conflicts:
                reason = conflicts[0].reason
        except StationError as error:
            reason = printable(error.message)
        except CONTAINED as error:  # shown with the fault
            reason = describe(error)
        stood_for = self._stands_for.get(failed.info.name, ())
        again = next((one for one in start if one.info.name in stood_for), None)
        if len(wanted) < len(failed.fallback):
            missing = [name for name in failed.fallback if name not in known]
            reason = f"{', '.join(map(repr, missing))} not loaded"
        elif again is not None:
            reason = (
                f"'{failed.info.name}' stands in for '{again.info.name}', which has "
                "failed; only a switch starts it again"
            )
        elif any(one in promised for one in start):
            reason = "a switch is about to start it"
        if reason is not None:
            failed.add_fault(f"no fallback: {reason}")
            return []
        return start

    def _start_replacement(
        self, one: LoadedController, failed: LoadedController, time: float
    ) -> None:
        if not one.ownership.acquire(blocking=False):
            failed.add_fault(f"fallback '{one.info.name}' is being unloaded")
            return
        problem = self.start_at_once(one, time, (failed.info,))
        one.ownership.release()
        earlier = self._stands_for.get(failed.info.name, ())
        self._stands_for[one.info.name] = (*earlier, failed.info.name)
        if problem is not None:
            failed.add_fault(f"fallback '{one.info.name}' did not start: {problem}")

    def do_switch(
        self,
        start: Sequence[ControllerInfo],
        stop: Sequence[ControllerInfo],
    ) -> str | None:
        """Pass a switch to the hardware; return the failure, if any."""
        # The robot may write its command buffers, and owners change. Controllers that
        # keep running do not write their commands again in this cycle.
        self.gate.is_stale = True
        before = [
            (one, one.commands.values())
            for one in self.loaded
            if one.controller.state is _RUNNING
        ]
        problem: str | None = None
        try:
            self.hw.do_switch(start, stop)
        except CONTAINED as error:  # shown in the result
            problem = reason_of("do_switch", error)
        for one, values in before:
            if problem is not None or one.info not in stop:
                one.commands.put_back(values)
        return problem


def _named(one: LoadedController, other: LoadedController) -> str:
    """Return a controller that another one needs, in words."""
    name = other.info.name
    if other in one.following:
        return f"its following controller '{name}'"
    return f"the controller '{name}', whose states it reads,"


def _without(one: LoadedController, missing: LoadedController) -> str:
    fault = missing.fault or "it was stopped"
    return f"{_named(one, missing)} does not run: {fault}"


def _below(one: LoadedController) -> list[LoadedController]:
    """Return all controllers down the chain of `one`."""
    return [each for next_ in one.following for each in (next_, *_below(next_))]


def _claims(info: ControllerInfo) -> list[tuple[str, str]]:
    """Return (hardware interface, resource) of everything a controller claims."""
    return [
        (claim.hardware_interface, resource)
        for claim in info.claimed_resources
        for resource in claim.resources
    ]
