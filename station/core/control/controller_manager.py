"""Loads, unloads, switches and lists controllers while the control thread runs them.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp; differs:
a refusal raises with its reason; loading and unloading do not wait for the control
thread and never hold it up (CM-32); a switch has a deadline in wall time and is
withdrawn as a whole (CM-74); callers are served one after the other (CM-76).
"""

import threading
from collections.abc import Callable, Sequence

from station.core.clock import Clock
from station.core.control.controller import ControllerBase, ControllerSample
from station.core.control.controller_factory import ControllerFactory
from station.core.control.controller_loader import ControllerLoader
from station.core.control.controller_runner import ControllerRunner
from station.core.control.controller_status import (
    ControllerStatistics,
    ControllerStatus,
)
from station.core.control.loaded_controller import LoadedController
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
    ControllerExistsError,
    ControllerNotFoundError,
    ControllerStateError,
    SwitchRefusedError,
    SwitchTimeoutError,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters

__all__ = ["ControllerManager", "ControllerStatus"]

SWITCH_BOUND = 5.0
"""How long a switch without a timeout may take [s wall time]."""
SWITCH_GRACE = 1.0
"""How much later than its timeout a switch is given up [s wall time] (CM-74)."""
WAIT_SLICE = 0.05
"""How often a waiting caller looks whether the loop's thread came or went [s]."""


class ControllerManager:
    """The controllers of one robot.

    `update`, `stop_all`, `void_commands` and `samples` are for the control thread.
    Everything else is for any other thread, waits for other callers if need be, and
    either does the whole thing or raises and changes nothing.

    Args:
        hw: The robot, initialised.
        parameters: Namespace in which every controller has a namespace of its name.
        loaders: Where controllers come from; asked in this order.
        clock: Wall time.

    Attributes:
        pump: Runs one cycle; called by a waiting caller when no thread runs the loop.
    """

    def __init__(
        self,
        hw: RobotHW,
        parameters: Parameters,
        loaders: Sequence[ControllerLoader],
        clock: Clock,
    ) -> None:
        self.pump: Callable[[], None] | None = None
        self._hw = hw
        self._factory = ControllerFactory(hw, parameters, loaders)
        self._clock = clock
        self._runner = ControllerRunner(hw)
        self._callers = threading.Lock()

    @property
    def start_gate(self) -> Callable[[], None] | None:
        """Called before a start, in the control thread; raises when none may be."""
        return self._runner.start_gate

    @start_gate.setter
    def start_gate(self, gate: Callable[[], None] | None) -> None:
        self._runner.start_gate = gate

    @property
    def cycle(self) -> int:
        """Number of updates so far."""
        return self._runner.cycle

    @property
    def interrupted(self) -> tuple[str, ...]:
        """Names of the controllers that the last interruption of the robot stopped."""
        return self._runner.interrupted

    def forget_interrupted(self) -> None:
        """Note that nothing is to be started again any more."""
        self._runner.interrupted = ()

    def update(
        self,
        time: float,
        period: float,
        reset_controllers: bool = False,  # noqa: FBT001, FBT002 - upstream's signature
    ) -> None:
        """Run one cycle: update the running controllers, then a pending switch.

        Args:
            time: Station time [s].
            period: Time since the last cycle [s], >= 0.
            reset_controllers: Stop and start every running controller first (CM-78).
        """
        self._runner.update(time, period, reset_controllers=reset_controllers)

    def carry_on_switch(self, time: float) -> bool:
        """Carry on with a pending switch in a cycle in which no time passes.

        Args:
            time: Station time [s].

        Returns:
            Whether there was one.
        """
        return self._runner.carry_on_switch(time)

    def stop_all(self, time: float) -> None:
        """Stop every controller now and rest the robot; ends a pending switch.

        Args:
            time: Station time [s].
        """
        self._runner.stop_all(time)

    def void_commands(self, reason: str) -> None:
        """Void every set-point that has not been picked up, and every goal.

        Args:
            reason: Why, one sentence; the goals that end say it.
        """
        self._runner.void_commands(reason)

    def samples(self) -> dict[str, ControllerSample]:
        """Return what each running controller did last, by name."""
        return self._runner.samples()

    def running_names(self) -> list[str]:
        """Return the names of the running controllers; takes no lock."""
        return self._runner.running_names()

    # Loading

    def load_controller(self, name: str) -> None:
        """Load the controller whose type and parameters are under `name` (CM-21).

        Args:
            name: Its name and namespace.

        Raises:
            ControllerExistsError: That name is loaded already (CM-22).
            ParameterError: Its type or a parameter is missing or impossible (CM-23).
            ControllerTypeNotFoundError: No loader knows its type (CM-24).
            ControllerLoadError: It cannot be created or initialised (CM-25 … CM-29).
        """
        self._refuse_control_thread("load")
        with self._callers:
            if any(loaded.info.name == name for loaded in self._runner.loaded):
                raise ControllerExistsError(
                    f"Controller '{name}' is loaded already.",
                    remedy="Unload it first, or choose another name.",
                    details={"controller": name},
                )
            loaded = self._factory.build(name)
            if loaded.controller.set_points is not None:
                loaded.controller.set_points.clock = self._clock
            self._runner.loaded = (*self._runner.loaded, loaded)

    def unload_controller(self, name: str) -> None:
        """Unload a controller that does not run (CM-34 … CM-36).

        Raises:
            ControllerNotFoundError: None of that name is loaded.
            ControllerStateError: It is running, or about to be.
        """
        self._refuse_control_thread("unload")
        with self._callers:
            self._unload(self._find(name))

    def list_controllers(self) -> list[ControllerStatus]:
        """Return all loaded controllers in load order (CM-81)."""
        return [loaded.status() for loaded in self._runner.loaded]

    def get_controller(self, name: str) -> ControllerBase:
        """Return the controller loaded as `name`.

        Raises:
            ControllerNotFoundError: None of that name is loaded.
        """
        return self._find(name).controller

    def list_controller_types(self) -> list[tuple[str, str]]:
        """Return (type, base class) of everything the loaders declare (CM-86)."""
        return self._factory.declared_types()

    def register_loader(self, loader: ControllerLoader) -> None:
        """Ask `loader`, too, after those that are known already."""
        with self._callers:
            self._factory.loaders.append(loader)

    def reload_controller_libraries(self, *, force_kill: bool = False) -> None:
        """Let every loader forget the code it imported (CM-87 … CM-89).

        Args:
            force_kill: Stop and unload all controllers first.

        Raises:
            ControllerStateError: Controllers are loaded and `force_kill` is false.
            SwitchRefusedError: The hardware does not let them be stopped.
            SwitchTimeoutError: They could not be stopped in time.
        """
        self._refuse_control_thread("reload", waits=True)
        with self._callers:
            names = [loaded.info.name for loaded in self._runner.loaded]
            if names and not force_kill:
                raise ControllerStateError(
                    f"Cannot reload: {len(names)} controllers are loaded: "
                    f"{', '.join(names)}.",
                    remedy="Unload them first, or set force_kill.",
                    details={"loaded": names},
                )
            if names:
                self._switch(SwitchRequest((), names, Strictness.BEST_EFFORT))
            for name in names:
                self._unload(self._find(name))
            self._factory.reload()

    def controller_statistics(self) -> list[ControllerStatistics]:
        """Return the times of all loaded controllers, in load order."""
        time = self._runner.time
        return [loaded.statistics(time) for loaded in self._runner.loaded]

    def reset_statistics(self) -> None:
        """Start the statistics of all controllers anew."""
        for loaded in self._runner.loaded:
            loaded.reset_statistics()

    # Switching

    def switch_controller(self, request: SwitchRequest) -> SwitchResult:
        """Start and stop controllers and the hardware with them, in one cycle.

        Returns when the control thread is done with it. With `dry_run` nothing is
        done, and the hardware is not asked to prepare.

        Args:
            request: What to start and to stop.

        Raises:
            ResourceConflictError: Two controllers would own the same resource
                (CM-52); `details` says who holds it.
            SwitchRefusedError: It is not possible; controllers and hardware are as
                before. Also a strict switch in which a controller did not start.
            SwitchTimeoutError: No cycle came in time and it was withdrawn, or the
                loop stood still in the middle of it.
            ControllerStateError: Called from within a cycle, which would wait for
                itself.
        """
        self._refuse_control_thread("switch", waits=True)
        with self._callers:
            return self._switch(request)

    def _switch(self, request: SwitchRequest) -> SwitchResult:
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
        self._hw.prepare_switch(plan.start, plan.stop)
        runner = self._runner
        pending = PendingSwitch(
            request,
            plan,
            [self._find(name) for name in plan.start_requests],
            [self._find(name) for name in plan.stop_requests],
            runner.time if runner.cycle else None,
        )
        runner.pending = pending
        try:
            self._wait_for(pending)
        except BaseException:
            self._withdraw(pending)
            raise
        return pending.result()

    def _plan(self, request: SwitchRequest) -> SwitchPlan:
        loaded = self._runner.loaded
        if self._runner.pending is not None:
            raise SwitchRefusedError(
                "The switch before has begun and is not finished: the control loop "
                "stands still.",
                remedy="Let the control loop run; then look at the controllers.",
            )
        plan = plan_switch(
            [Candidate(one.info, one.controller.state) for one in loaded], request
        )
        conflicts = self._hw.check_for_conflict(plan.running)
        if conflicts:
            running = [o.info.name for o in loaded if o.controller.is_running()]
            raise conflict_error(conflicts, running)
        return plan

    def _wait_for(self, pending: PendingSwitch) -> None:
        """Return when the control thread has finished `pending`.

        Raises:
            SwitchTimeoutError: It has not, at the deadline.
        """
        timeout = pending.request.timeout
        bound = timeout + SWITCH_GRACE if timeout > 0.0 else SWITCH_BOUND
        clock, runner = self._clock, self._runner
        offset = clock.now() - runner.time  # pumped cycles take station time
        deadline = clock.now() + bound
        while pending.progress is not SwitchProgress.FINISHED:
            now = max(clock.now(), runner.time + offset if self.pump else 0.0)
            if now >= deadline:
                if pending.expired or self._withdraw(pending):
                    raise self._timed_out(pending, bound)
                deadline = now + SWITCH_GRACE  # begun: the next cycle ends it
            elif self.pump is not None:
                self.pump()
            else:
                clock.wait_for(pending.done, min(deadline, now + WAIT_SLICE))

    def _withdraw(self, pending: PendingSwitch) -> bool:
        """Take back a switch that has not begun; let one that has end itself."""
        if pending.claim.acquire(blocking=False):
            self._runner.pending = None
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

    # What the above share

    def _refuse_control_thread(self, verb: str, *, waits: bool = False) -> None:
        runner = self._runner
        here = threading.get_ident() == runner.thread
        if here and (runner.updating or (waits and self.pump is None)):
            raise ControllerStateError(
                f"Cannot {verb} controllers from the control thread: it would wait for "
                "itself.",
                remedy="Do it in another thread; a loop of your own can set `pump`.",
            )

    def _find(self, name: str) -> LoadedController:
        for loaded in self._runner.loaded:
            if loaded.info.name == name:
                return loaded
        names = ", ".join(loaded.info.name for loaded in self._runner.loaded)
        raise ControllerNotFoundError(
            f"No controller '{name}' is loaded.",
            remedy=f"Loaded are: {names or 'none'}.",
            details={"controller": name},
        )

    def _unload(self, loaded: LoadedController) -> None:
        name = loaded.info.name
        # Whoever holds the ownership decides: here, or a fallback being started.
        owned = loaded.ownership.acquire(blocking=False)
        if not owned or loaded.controller.is_running() or self._is_pending(loaded):
            if owned:
                loaded.ownership.release()
            raise ControllerStateError(
                f"Controller '{name}' cannot be unloaded: it is "
                f"{loaded.controller.state.value}.",
                remedy=f"Stop '{name}' first.",
                details={"controller": name, "state": loaded.controller.state.value},
            )
        self._runner.loaded = tuple(
            one for one in self._runner.loaded if one is not loaded
        )

    def _is_pending(self, loaded: LoadedController) -> bool:
        pending = self._runner.pending
        return pending is not None and loaded in (*pending.start, *pending.stop)
