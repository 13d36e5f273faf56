"""The caller's half of a switch: plan it, ask the robot, post it, wait for the end.

Only one switch at a time asks the robot, whose `prepare_switch` and
`check_for_conflict` may take long. Later callers wait, each up to its own bound.
Loading, unloading and listing controllers do not wait for the switch.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf

from station.core.clock import Clock
from station.core.control.chains import depth_of, find_conflicts
from station.core.control.controller_update import ControllerUpdate
from station.core.control.pending_switch import PendingSwitch, SwitchProgress
from station.core.control.switching import (
    Candidate,
    Strictness,
    SwitchPlan,
    SwitchRequest,
    SwitchResult,
    conflict_error,
    plan_switch,
)
from station.core.errors import (
    CONTAINED,
    ControllerStateError,
    StationError,
    SwitchRefusedError,
    SwitchTimeoutError,
    reason_of,
    trace_of_fault,
)
from station.core.hardware.robot_hw import RobotHW

SWITCH_GRACE = 1.0
"""Time after its timeout at which a switch is given up [s wall time] (CM-74)."""
WAIT_SLICE = 0.05
"""Interval at which a waiting caller checks whether a thread runs the loop [s]."""


class SwitchCaller:
    """Brings switches from their callers to the control thread.

    Args:
        hw: The robot.
        update: Carries switches out, once per cycle.
        clock: Wall time.
        lock: Guards the list of controllers; held for moments only.

    Attributes:
        pump: Runs one cycle; called by a waiting caller when no thread runs the loop.
        planned: Names of the controllers of the switch under way; not to be unloaded.
    """

    def __init__(
        self, hw: RobotHW, update: ControllerUpdate, clock: Clock, lock: threading.Lock
    ) -> None:
        self.pump: Callable[[], None] | None = None
        self.planned: set[str] = set()
        self._hw = hw
        self._update = update
        self._clock = clock
        self._lock = lock
        self._switching = threading.Lock()
        self._switcher = 0  # identity of the thread that has `_switching`

    def switch(self, request: SwitchRequest) -> SwitchResult:
        """Carry a switch out after earlier ones; see `ControllerManager`."""
        with self.one_at_a_time(_bound_of(request)):
            return self.carry_out(request)

    @contextmanager
    def one_at_a_time(self, bound: float) -> Iterator[None]:
        """Let one switch at a time ask the robot.

        Args:
            bound: How long to wait for the previous switch [s wall time].

        Raises:
            ControllerStateError: The caller is a hook of the robot, or a policy, that
                is being asked about another switch.
            SwitchTimeoutError: The previous switch is not finished in time.
        """
        here = threading.get_ident()
        if self._switcher == here:
            raise ControllerStateError(
                "Cannot switch controllers while a switch is being prepared by the "
                "same thread: it would wait for itself.",
                remedy="Do not switch within prepare_switch or check_for_conflict.",
            )
        if not self._switching.acquire(timeout=-1 if bound == inf else bound):
            raise SwitchTimeoutError(
                f"The switch before was not finished within {bound} s of wall time: "
                "the robot has not answered prepare_switch or check_for_conflict, or "
                "the control loop does not run.",
                remedy="Look at the robot and at the loop, then switch again.",
                details={"timeout": bound, "begun": False},
            )
        self._switcher = here
        try:
            yield
        finally:
            self._switcher = 0
            self._switching.release()

    def carry_out(self, request: SwitchRequest) -> SwitchResult:
        """Carry a switch out; called within `one_at_a_time`.

        Args:
            request: Controllers to start and to stop.

        Raises:
            StationError: As for `ControllerManager.switch_controller`.
        """
        plan = self._plan(request)
        if request.dry_run:
            return SwitchResult(
                ok=True,
                started=tuple(info.name for info in plan.start),
                stopped=tuple(info.name for info in plan.stop),
                cycle=0,
                plan=plan,
                dry_run=True,
            )
        update = self._update
        with self._lock:
            # From here on no caller unloads a controller of this switch.
            start = [update.lifecycle.find(name) for name in plan.start_requests]
            stop = [update.lifecycle.find(name) for name in plan.stop_requests]
            # A following controller starts first and stops last; without chains the
            # order of the request stays.
            start.sort(key=depth_of)
            stop.sort(key=lambda one: -depth_of(one))
            self.planned.update(plan.start_requests, plan.stop_requests)
        try:
            with _foreign("prepare_switch"):
                self._hw.prepare_switch(plan.start, plan.stop)
            since = update.time if update.cycle else None
            pending = PendingSwitch(request, plan, start, stop, since)
            update.pending = pending
            try:
                self._wait_for(pending)
            except BaseException:
                self._withdraw(pending)
                raise
        finally:
            with self._lock:
                self.planned.clear()
        return pending.result()

    def _plan(self, request: SwitchRequest) -> SwitchPlan:
        loaded = self._update.lifecycle.loaded
        if self._update.pending is not None:
            raise SwitchRefusedError(
                "The switch before has begun and is not finished: the control loop "
                "stands still.",
                remedy="Let the control loop run; then look at the controllers.",
            )
        candidates = [
            Candidate(
                one.info,
                one.controller.state,
                one.is_unreleased,
                tuple(each.info.name for each in one.following),
                tuple(each.info.name for each in one.read),
            )
            for one in loaded
        ]
        running = [one.info.name for one in loaded if one.controller.is_running()]
        left_out: list[str] = []
        while True:
            plan = plan_switch(candidates, request)
            unavailable = self._unavailable(plan, request)
            if unavailable:
                left_out += unavailable.values()
                kept = [name for name in request.start if name not in unavailable]
                request = replace(request, start=kept)
                continue
            with _foreign("check_for_conflict"):
                conflicts = find_conflicts(self._hw, plan.running)
            if not conflicts:
                return replace(plan, ignored=(*left_out, *plan.ignored))
            held = {
                name
                for conflict in conflicts
                for name, _ in conflict.holders
                if name in running and name not in plan.start_requests
            } - set(plan.stop_requests)
            if request.strictness is not Strictness.FORCE_AUTO or not held:
                raise conflict_error(conflicts, running)
            # Each round stops one more controller, so the loop ends.
            request = replace(request, stop=(*request.stop, *sorted(held)))

    def _unavailable(self, plan: SwitchPlan, request: SwitchRequest) -> dict[str, str]:
        """Return the reasons why controllers cannot start on their hardware, by name.

        Raises:
            SwitchRefusedError: There is such a controller, and the request is strict.
        """
        components = self._update.lifecycle.components
        found = {
            info.name: f"Controller '{info.name}' cannot start: {reason}."
            for info in plan.start
            if (reason := components.refusal(info)) is not None
        }
        if found and request.strictness is not Strictness.BEST_EFFORT:
            name, message = next(iter(found.items()))
            raise SwitchRefusedError(
                message,
                remedy="Set the hardware component active first.",
                details={"controller": name},
            )
        return found

    def _wait_for(self, pending: PendingSwitch) -> None:
        """Wait until the control thread has finished `pending`.

        Raises:
            SwitchTimeoutError: The switch has not ended at the deadline.
        """
        bound = _bound_of(pending.request)
        clock, update = self._clock, self._update
        offset = clock.now() - update.time  # pumped cycles take station time
        deadline = clock.now() + bound
        cycle = update.cycle
        while pending.progress is not SwitchProgress.FINISHED:
            now = max(clock.now(), update.time + offset if self.pump else 0.0)
            if now >= deadline:
                stands_still = pending.expired and update.cycle == cycle
                if stands_still or self._withdraw(pending):
                    raise self._timed_out(pending, bound)
                # It has begun: the next cycles end it or take it back.
                deadline, cycle = now + SWITCH_GRACE, update.cycle
            elif self.pump is not None:
                self.pump()
            else:
                clock.wait_for(pending.done, min(deadline, now + WAIT_SLICE))

    def _withdraw(self, pending: PendingSwitch) -> bool:
        """Take a switch back and return True; if it has begun, let it expire."""
        if pending.claim.acquire(blocking=False):
            self._update.pending = None
            return True
        pending.expired = True
        return False

    def _timed_out(self, pending: PendingSwitch, bound: float) -> SwitchTimeoutError:
        begun = pending.progress is not SwitchProgress.POSTED
        if begun:
            outcome = "It has begun; the next cycle ends it and aborts what waits."
        else:
            outcome = "It was withdrawn; controllers and hardware are as before."
        return SwitchTimeoutError(
            f"The switch was not finished within {bound} s of wall time, because the "
            f"control loop does not run. {outcome}",
            remedy="Start or resume the control loop, then switch again.",
            details={"timeout": bound, "begun": begun},
        )


def _bound_of(request: SwitchRequest) -> float:
    """Return the longest allowed duration of a switch [s wall time]; inf for none."""
    if request.timeout > 0.0:
        return request.timeout + SWITCH_GRACE
    return inf if request.bound is None else request.bound


@contextmanager
def _foreign(hook: str) -> Iterator[None]:
    """Report every error of a robot's hook as a refusal of the switch.

    Raises:
        StationError: The hook refuses.
        SwitchRefusedError: The hook raised anything else.
    """
    try:
        yield
    except StationError:
        raise
    except CONTAINED as error:
        raise SwitchRefusedError(
            f"The robot cannot say whether the switch is possible: "
            f"{reason_of(hook, error)}.",
            remedy=f"Correct the robot's {hook}; nothing was switched.",
            details={"hook": hook, "traceback": trace_of_fault()},
        ) from error
