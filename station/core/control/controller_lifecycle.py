"""One controller's way through its life in the control thread, faults contained.

Source: ros_control@0.20.0 controller_interface/controller_base.h; differs: an exception
or a command that is not finite takes its controller off the robot, in the same cycle
and alone (CM-80); the first command of a started controller is checked for a jump.
"""

from collections.abc import Callable, Sequence

from station.core.control.controller import ControllerState
from station.core.control.loaded_controller import LoadedController
from station.core.errors import StationError
from station.core.faults import (
    CONTAINED,
    describe,
    printable,
    reason_of,
    trace_of_fault,
)
from station.core.hardware.robot_hw import ControllerInfo, RobotHW, SwitchState


class ControllerLifecycle:
    """Starts, stops and aborts loaded controllers; for the control thread.

    Throughout, `time` is station time [s].

    Args:
        hw: The robot.

    Attributes:
        loaded: All loaded controllers in load order; replaced as a whole.
        start_gate: Called before anything is started; raises a StationError when
            nothing may be. None when there is no such rule.
    """

    def __init__(self, hw: RobotHW) -> None:
        self.hw = hw
        self.loaded: tuple[LoadedController, ...] = ()
        self.start_gate: Callable[[], None] | None = None

    def start(
        self,
        one: LoadedController,
        time: float,
        stopped: tuple[ControllerInfo, ...],
        jump: dict[str, float],
    ) -> str:
        """Start one controller; return why that was not possible, or nothing.

        Args:
            one: The controller; it may be running already (CM-48, CM-51).
            time: Station time [s].
            stopped: Controllers stopped in the same cycle; commands of resources that
                they had, through the same interface, go on from the last command.
            jump: Gets the step of every command, by resource.
        """
        controller = one.controller
        if controller.state is ControllerState.CONSTRUCTED:
            return "it was never initialised"
        own = (one.info,) if controller.state is ControllerState.RUNNING else ()
        unknown = one.prepare({
            claim for info in (*stopped, *own) for claim in _claims(info)
        })
        if unknown:
            self.fail(one, time, unknown, "")
            return unknown
        try:
            controller.start_request(time)
            bad = "" if one.is_finite() else one.bad_command()
            problem = f"starting wrote the {bad}" if bad else one.excessive_jump()
            trace = ""
        except CONTAINED as error:  # contained, kept and shown
            problem, trace = reason_of("starting", error), trace_of_fault()
        if not problem:
            one.fault = one.traceback = ""
            one.watch_first_update()
        if not trace:
            jump.update(one.jumps())
        if problem:
            self.fail(one, time, problem, trace)
        return problem

    def start_at_once(
        self,
        one: LoadedController,
        time: float,
        stopped: tuple[ControllerInfo, ...],
    ) -> str:
        """Start one controller if the hardware is ready; return why not, or nothing.

        Args:
            one: The controller.
            time: Station time [s].
            stopped: As for `start`.
        """
        try:
            ready = self.hw.switch_result_for(one.info) is SwitchState.DONE
            problem = "" if ready else "the hardware was not ready at once"
        except CONTAINED as error:  # kept and shown
            problem = reason_of("switch_result_for", error)
        if problem:
            self.fail(one, time, problem, "")
            return problem
        return self.start(one, time, stopped, {})

    def check_first_update(self, one: LoadedController, time: float) -> None:
        """Look at the command of the first update; the second look at a start."""
        one.fresh = False
        if one.got_set_point():
            return  # somebody wants it to move already
        problem = one.excessive_jump()
        if problem:
            self.fail(one, time, problem, "")
            self.fall_back(one, time)

    def stop(self, one: LoadedController, time: float) -> None:
        """Stop one controller; an exception of its `stopping` is kept as its fault."""
        try:
            one.controller.stop_request(time)
        except CONTAINED as error:  # contained, kept and shown
            one.controller.state = ControllerState.STOPPED
            one.fault = reason_of("stopping", error)
            one.traceback = trace_of_fault()
            one.abort_goals(f"The controller failed: {one.fault}.")
            one.write_rest()

    def wait(self, one: LoadedController, time: float) -> str:
        """Tell one controller that the hardware is switching; return what failed."""
        try:
            one.controller.wait_request(time)
        except CONTAINED as error:  # contained, kept and shown
            problem = reason_of("waiting", error)
            self.fail(one, time, problem, trace_of_fault())
            return problem
        return ""

    def abort(self, one: LoadedController, time: float, problem: str) -> None:
        """Mark one controller as not running, because of `problem`; it rests."""
        one.fault, one.traceback, one.fresh = problem, "", False
        one.write_rest()
        one.abort_goals(f"The controller failed: {problem}.")
        try:
            one.controller.abort_request(time)
        except CONTAINED as error:  # contained, kept and shown
            one.controller.state = ControllerState.ABORTED
            one.fault += f" ({reason_of('aborting', error)})"
            one.traceback = trace_of_fault()

    def reset(self, one: LoadedController, time: float) -> None:
        """Stop and start one controller if it runs (CM-78)."""
        if one.controller.state is ControllerState.RUNNING:
            self.stop(one, time)
            self.start(one, time, (one.info,), {})

    def fail(self, one: LoadedController, time: float, reason: str, trace: str) -> None:
        """Take a failed controller off the robot in this cycle; it becomes aborted."""
        self.abort(one, time, reason)
        one.traceback = trace or one.traceback
        one.write_rest()  # again: `aborting` may have commanded something
        self.do_switch([], [one.info])

    def fall_back(self, failed: LoadedController, time: float) -> None:
        """Start what shall take over from `failed`, in this cycle; else it rests."""
        replacements = self._replacements(failed)
        if not replacements:
            return
        self.do_switch([one.info for one in replacements], [])
        for one in replacements:
            self._start_replacement(one, failed, time)

    def _replacements(self, failed: LoadedController) -> list[LoadedController]:
        """Return the fallback of `failed` when all of it can run now, else nothing."""
        if not failed.fallback:
            return []
        known = {one.info.name: one for one in self.loaded}
        wanted = [known[name] for name in failed.fallback if name in known]
        running = [
            one.info
            for one in self.loaded
            if one.controller.state is ControllerState.RUNNING
        ]
        start = [
            one for one in wanted if one.controller.state is not ControllerState.RUNNING
        ]
        try:
            if self.start_gate is not None:
                self.start_gate()
            conflicts = self.hw.check_for_conflict([
                *running,
                *(one.info for one in start),
            ])
            reason = conflicts[0].reason if conflicts else ""
        except StationError as error:
            reason = printable(error.message)
        except CONTAINED as error:  # shown with the fault
            reason = describe(error)
        if len(wanted) < len(failed.fallback):
            reason = "not all of it is loaded"
        if reason:
            failed.fault += f" (no fallback: {reason})"
            return []
        return start

    def _start_replacement(
        self, one: LoadedController, failed: LoadedController, time: float
    ) -> None:
        if not one.ownership.acquire(blocking=False):
            failed.fault += f" (fallback '{one.info.name}' is being unloaded)"
            return
        problem = self.start_at_once(one, time, (failed.info,))
        one.ownership.release()
        if problem:
            failed.fault += f" (fallback '{one.info.name}' did not start: {problem})"

    def do_switch(
        self,
        start: Sequence[ControllerInfo],
        stop: Sequence[ControllerInfo],
    ) -> str:
        """Tell the hardware; return what went wrong, or nothing."""
        try:
            self.hw.do_switch(start, stop)
        except CONTAINED as error:  # shown in the result
            return reason_of("do_switch", error)
        return ""


def _claims(info: ControllerInfo) -> list[tuple[str, str]]:
    """Return (hardware interface, resource) of everything a controller claims."""
    return [
        (claim.hardware_interface, resource)
        for claim in info.claimed_resources
        for resource in claim.resources
    ]
