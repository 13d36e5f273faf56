"""Loads, unloads, switches and lists controllers while the control thread runs them.

Source: ros_control@0.20.0 controller_manager/src/controller_manager.cpp; differs:
a refusal raises with its reason; loading and unloading do not wait for the control
thread and never hold it up (CM-32); a switch has a deadline in wall time and is
withdrawn as a whole (CM-74); switches are served one after the other (CM-76).

No foreign code runs under a lock that others wait for: controllers are loaded in
threads of their own (`loading.py`), and a robot that takes long to prepare a switch
delays only other switches (`switch_caller.py`).
"""

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from station.core.clock import Clock
from station.core.control.chains import chains_report, insert_in_order
from station.core.control.controller import (
    ControllerBase,
    ControllerCondition,
    ControllerSample,
    ControllerState,
    ControllerStatistics,
    ControllerStatus,
)
from station.core.control.controller_factory import (
    LOAD_TIMEOUT,
    ControllerFactory,
    ControllerType,
    Loading,
)
from station.core.control.controller_lifecycle import ControllerLifecycle
from station.core.control.controller_loader import ControllerLoader
from station.core.control.controller_update import ControllerUpdate
from station.core.control.hardware_components import ComponentState
from station.core.control.loaded_controller import LoadedController
from station.core.control.switch_caller import SwitchCaller
from station.core.control.switching import (
    SWITCH_BOUND,
    Strictness,
    SwitchRequest,
    SwitchResult,
)
from station.core.errors import (
    ControllerExistsError,
    ControllerLoadError,
    ControllerStateError,
)
from station.core.hardware.async_robot_hw import AsyncRobotHW
from station.core.hardware.robot_hw import ControllerInfo, RobotHW
from station.core.parameters import Parameters
from station.reports import ControllerChains, HardwareComponentReport

__all__ = ["ControllerManager", "ControllerStatus"]

CONTROLLER_MANAGER = "controller_manager"
"""Namespace of the manager's own parameters, as in files of ROS 2."""
_PATIENCE = 0.004
"""Longest time that a list of controllers waits for the end of a switch [s]. It is
short because the event loop that asks for the list also answers the stop."""


class ControllerManager:
    """The controllers of one robot.

    `update`, `stop_all` and `samples` are for the control thread. All other methods are
    for any other thread: they wait for other callers if need be, and either succeed as
    a whole or raise and change nothing.

    Args:
        hw: The robot, initialised.
        parameters: Namespace in which each controller's parameters are under its name.
        loaders: The sources of controllers, asked in this order.
        clock: Wall time.

    Raises:
        HardwareComponentError: A hook of the hardware refuses or fails.
        ParameterError: `controller_manager/hardware_components_initial_state` names an
            unknown component or state.

    Attributes:
        lifecycle: Starts and stops the controllers, and has the list of them.
        controller_update: Does the work of `update`, for a loop; knows the controllers
            that were interrupted and the longest time that an update may take.
        loop_cycle: Returns the number of the loop's present cycle.
    """

    def __init__(
        self,
        hw: RobotHW,
        parameters: Parameters,
        loaders: Sequence[ControllerLoader],
        clock: Clock,
    ) -> None:
        self._hw = hw
        self._factory = ControllerFactory(hw, parameters, loaders)
        self._clock = clock
        self._async_hardware = tuple({
            one.robot: None
            for one in hw.components()
            if isinstance(one.robot, AsyncRobotHW)
        })
        for robot in self._async_hardware:
            robot.set_stepped(lambda: self.pump is not None)
        self.lifecycle = ControllerLifecycle(hw)
        self.lifecycle.components.begin(parameters.namespace(CONTROLLER_MANAGER))
        self.controller_update = ControllerUpdate(self.lifecycle)
        self._lock = threading.Lock()
        self._switches = SwitchCaller(hw, self.controller_update, clock, self._lock)
        self._loading: dict[str, Loading] = {}
        self._listed: dict[str, ControllerStatus] = {}
        self._period = 0.0
        self.loop_cycle: Callable[[], int] = lambda: self.cycle

    @property
    def period(self) -> float:
        """Nominal period of the loop [s]; 0 while no loop has been made."""
        return self._period

    @period.setter
    def period(self, period: float) -> None:
        self._period = period
        for one in self.lifecycle.loaded:
            one.set_loop_period(period)

    @property
    def pump(self) -> Callable[[], None] | None:
        """Runs one cycle; called by a waiting caller when no thread runs the loop."""
        return self._switches.pump

    @pump.setter
    def pump(self, pump: Callable[[], None] | None) -> None:
        self._switches.pump = pump

    @property
    def command_violations(self) -> tuple[int, str | None]:
        """Return the number of commands written without a claim, and the last one."""
        gate = self.lifecycle.gate
        return gate.violations, gate.last_violation

    @property
    def cycle(self) -> int:
        """Number of updates so far."""
        return self.controller_update.cycle

    def update(
        self,
        time: float,
        period: float,
        reset_controllers: bool = False,  # noqa: FBT001, FBT002 - upstream's signature
    ) -> None:
        """Run one cycle: update the running controllers, then a pending switch.

        Args:
            time: Station time [s], >= 0.
            period: Time since the last cycle [s], >= 0.
            reset_controllers: Stop and start every running controller first (CM-78).

        Raises:
            ValueError: `time` or `period` is negative or not finite.
        """
        if reset_controllers:
            self.controller_update.resets = True
        self.controller_update.update_controllers(time, period)

    def stop_all(self, time: float) -> None:
        """Stop every controller now and rest the robot; ends a pending switch.

        Args:
            time: Station time [s].
        """
        self.controller_update.stop_all(time)

    def samples(self) -> dict[str, ControllerSample]:
        """Return the last sample of each running controller, by name."""
        found = {
            one.info.name: one.controller.sample
            for one in self.lifecycle.loaded
            if one.controller.state is ControllerState.RUNNING
        }
        return {name: sample for name, sample in found.items() if sample is not None}

    def running_names(self) -> list[str]:
        """Return the names of the running controllers; takes no lock."""
        loaded = self.lifecycle.loaded
        return [one.info.name for one in loaded if one.controller.is_running()]

    # Loading

    def load_controller(
        self, name: str, timeout: float = LOAD_TIMEOUT, *, strict: bool = False
    ) -> None:
        """Load the controller whose type and parameters are under `name` (CM-21).

        Import, constructor and `init` of the controller run in a thread of their own
        while this caller waits; meanwhile `list_controllers` shows it as loading.

        Args:
            name: Name of the controller, and of its namespace.
            timeout: Longest time to wait for it [s wall time], > 0.
            strict: Whether to refuse a parameter that the type does not know, or only
                to note it.

        Raises:
            ControllerExistsError: That name is loaded already (CM-22), or being loaded.
            ParameterError: Its type or a parameter is missing or impossible (CM-23).
            ControllerTypeNotFoundError: No loader knows its type (CM-24).
            ControllerLoadError: The controller cannot be made (CM-25 … CM-29),
                or not in time, or the loading was cancelled.
        """
        with self.announce(name, strict=strict) as loading:
            self.finish_loading(loading, timeout)

    @contextmanager
    def announce(self, name: str, *, strict: bool = False) -> Iterator[Loading]:
        """Reserve a name for a controller to be loaded, as long as the context lasts.

        `finish_loading` loads the controller. A caller may change the parameters of the
        name before, and put them back if the loading fails: no other caller loads the
        name meanwhile.

        Raises:
            ControllerExistsError: That name is loaded already (CM-22), or being loaded.
        """
        self._refuse_control_thread("load")
        loading = Loading(
            name,
            lambda: self._factory.build(name, self.lifecycle.loaded, strict=strict),
        )
        with self._lock:
            is_loading = name in self._loading
            if is_loading or self._is_loaded(name):
                state = "is being loaded" if is_loading else "is loaded already"
                way_out = "Unload it first" if not is_loading else "Unload it to cancel"
                raise ControllerExistsError(
                    f"Controller '{name}' {state}.",
                    remedy=f"{way_out}, or choose another name.",
                    details={"controller": name},
                )
            self._loading[name] = loading
        try:
            yield loading
        finally:
            with self._lock:
                # After a successful load, another caller may be loading the name again.
                if self._loading.get(name) is loading:
                    del self._loading[name]

    def finish_loading(self, loading: Loading, timeout: float = LOAD_TIMEOUT) -> None:
        """Load the controller that was announced, as `load_controller` does."""
        loaded = loading.load(timeout)
        # The port judges the age of set-points by the station's clock.
        if loaded.controller.set_points is not None:
            loaded.controller.set_points.clock = self._clock
        with self._lock:
            self._refuse_lost_exports(loaded)
            if loaded.beside is not None:
                loaded.beside.is_stepped = lambda: self.pump is not None
                loaded.beside.present_cycle = lambda: self.loop_cycle()
            if self._period > 0.0:
                loaded.set_loop_period(self._period)
            self.lifecycle.loaded = insert_in_order(self.lifecycle.loaded, loaded)
            del self._loading[loading.name]

    def is_loading(self, name: str) -> bool:
        """Return whether a controller of that name is being loaded."""
        return name in self._loading

    def _is_loaded(self, name: str) -> bool:
        return any(one.info.name == name for one in self.lifecycle.loaded)

    def unload_controller(self, name: str) -> None:
        """Unload a controller that does not run (CM-34 … CM-36).

        If it is being loaded, the loading is cancelled and raises an error.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller runs, or is about to, or the robot has
                not been informed of its stop.
        """
        self._refuse_control_thread("unload")
        with self._lock:
            if name in self._loading:
                self._loading[name].cancel()
                return
            self._unload(self.lifecycle.find(name))

    def list_controllers(self) -> list[ControllerStatus]:
        """Return the loaded controllers in load order (CM-81), then those loading.

        All statuses are of one moment between two switches: in the middle of a switch a
        joint would seem to have two owners. If a switch takes longer than `_PATIENCE`,
        the list is the last one from before the switch.
        """
        loaded = self._between_changes()
        return [*loaded, *(one.status() for one in list(self._loading.values()))]

    def _between_changes(self) -> list[ControllerStatus]:
        changes, clock = self.controller_update.changes, self._clock
        deadline = clock.now() + _PATIENCE
        is_inside = threading.get_ident() == self.controller_update.thread
        while True:
            before = changes.count
            # The count is odd during a change. The thread that makes the change must
            # not wait for itself.
            if before % 2 == 0 or is_inside:
                # If the count has not moved meanwhile, the statuses are of one moment.
                found = [one.status() for one in self.lifecycle.loaded]
                if changes.count == before:
                    self._listed = {status.name: status for status in found}
                    return found
            now = clock.now()
            # A slightly old list is better than an event loop that waits.
            if now >= deadline:
                loaded, listed = self.lifecycle.loaded, self._listed
                return [listed.get(o.info.name) or o.status() for o in loaded]
            clock.sleep_until(now + _PATIENCE / 20.0)

    def conditions(self) -> list[ControllerCondition]:
        """Return state and fault of each loaded controller, without statistics.

        Computing the statistics of `list_controllers` holds the interpreter too long
        for a reader that looks many times a second.
        """
        return [one.condition() for one in self.lifecycle.loaded]

    def running(self) -> list[ControllerInfo]:
        """Return the running controllers with their claims, in load order."""
        loaded = self.lifecycle.loaded
        return [one.info for one in loaded if one.controller.is_running()]

    def is_switching(self) -> bool:
        """Return whether a switch was posted to the control thread and is not over."""
        return self.controller_update.pending is not None

    def get_controller(self, name: str) -> ControllerBase:
        """Return the controller loaded as `name`.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
        """
        return self.lifecycle.find(name).controller

    def list_controller_types(self) -> list[tuple[str, str]]:
        """Return (type, base class) of everything the loaders declare (CM-86)."""
        return self._factory.declared_types()

    def describe_controller_types(self) -> list[ControllerType]:
        """Return all declared types with their parameters; may import modules.

        Not for the control thread.
        """
        return self._factory.describe_types()

    def register_loader(self, loader: ControllerLoader) -> None:
        """Add a loader, which is asked after those that are known already."""
        with self._lock:
            self._factory.loaders.append(loader)

    def reload_controller_libraries(self, *, force_kill: bool = False) -> list[str]:
        """Let every loader forget the code it imported (CM-87 … CM-89).

        Args:
            force_kill: Stop and unload all controllers first.

        Returns:
            Names of the controllers that were unloaded.

        Raises:
            ControllerStateError: Controllers are loaded and `force_kill` is false.
            SwitchRefusedError: The hardware does not let them be stopped.
            SwitchTimeoutError: The controllers could not be stopped in time.
        """
        self._refuse_control_thread("reload", waits=True)
        with self._switches.one_at_a_time(SWITCH_BOUND):
            names = [loaded.info.name for loaded in self.lifecycle.loaded]
            if names and not force_kill:
                raise ControllerStateError(
                    f"Cannot reload while controllers are loaded: {', '.join(names)}.",
                    remedy="Unload them first, or set force_kill.",
                    details={"loaded": names},
                )
            # Best effort: controllers that do not run are no reason to refuse.
            if names:
                self._switches.carry_out(
                    SwitchRequest((), names, Strictness.BEST_EFFORT)
                )
            with self._lock:
                for name in names:
                    self._unload(self.lifecycle.find(name))
            self._factory.reload()
            return names

    def chains(self) -> ControllerChains:
        """Return for each controller the controllers that it commands or reads."""
        return chains_report(self.lifecycle.loaded)

    def controller_statistics(self) -> list[ControllerStatistics]:
        """Return the update times of all loaded controllers, in load order."""
        time = self.controller_update.time
        return [loaded.statistics(time) for loaded in self.lifecycle.loaded]

    def end_async_threads(self) -> None:
        """End the threads of asynchronous controllers and robots; no loop may run.

        Controllers and hardware stay active: a loop that runs again makes new threads.
        """
        for one in self.lifecycle.loaded:
            if one.beside is not None:
                one.beside.end_thread()
        for robot in self._async_hardware:
            robot.calls.end_thread()

    def reset_statistics(self) -> None:
        """Start the statistics of all controllers anew."""
        for loaded in self.lifecycle.loaded:
            loaded.times.reset()

    # Switching

    def switch_controller(self, request: SwitchRequest) -> SwitchResult:
        """Start and stop controllers and the hardware with them, in one cycle.

        Returns when the control thread has finished the switch. With `dry_run` nothing
        changes, and the hardware is not asked to prepare.

        Args:
            request: Controllers to start and to stop.

        Raises:
            ResourceConflictError: Two controllers would own the same resource
                (CM-52); `details` says who holds it.
            SwitchRefusedError: The switch is not possible, or a controller did not
                start in a strict one; controllers and hardware are as before.
            SwitchTimeoutError: No cycle came in time and the switch was withdrawn, or
                the loop stood still in the middle of it.
            ControllerStateError: Called from within a cycle, which would wait for
                itself.
        """
        self._refuse_control_thread("switch", waits=True)
        return self._switches.switch(request)

    # Hardware

    def hardware_components(self) -> list[HardwareComponentReport]:
        """Return the hardware components, with their states and interfaces."""
        return self.lifecycle.components.report(self.running())

    def hardware_users(self, name: str) -> list[str]:
        """Return the names of the running controllers that command a component.

        Raises:
            HardwareComponentNotFoundError: There is no such component.
        """
        return self.lifecycle.components.users(name, self.running())

    def set_hardware_component_state(self, name: str, state: ComponentState) -> None:
        """Bring a hardware component into a state; call the hooks that lead there.

        Args:
            name: The component.
            state: The state.

        Raises:
            HardwareComponentNotFoundError: There is no such component.
            HardwareComponentError: It is in use or finalized, or a hook refuses.
            SwitchTimeoutError: The switch before this call did not finish in time.
            ControllerStateError: Called from within a cycle, or by a hook.
        """
        self._refuse_control_thread("set hardware for", waits=True)
        # A switch checks these states before it begins: they must stay meanwhile.
        with self._switches.one_at_a_time(SWITCH_BOUND):
            self.lifecycle.components.change(name, state, self.running)

    # What these methods share

    def _refuse_control_thread(self, verb: str, *, waits: bool = False) -> None:
        update = self.controller_update
        here = threading.get_ident() == update.thread
        if here and (update.is_updating or (waits and self.pump is None)):
            raise ControllerStateError(
                f"Cannot {verb} controllers from the control thread: it would wait for "
                "itself.",
                remedy="Do it in another thread; a loop of your own can set `pump`.",
            )

    def _refuse_lost_exports(self, loaded: LoadedController) -> None:
        """Refuse a controller whose claimed exports were unloaded while it was loading.

        Raises:
            ControllerLoadError: An export that it claims was unloaded.
        """
        for one in (*loaded.following, *loaded.read):
            if one not in self.lifecycle.loaded:
                raise ControllerLoadError(
                    f"Controller '{loaded.info.name}' claims references or states of "
                    f"'{one.info.name}', which was unloaded meanwhile.",
                    remedy=f"Load '{one.info.name}' again, then this controller.",
                    details={"controller": loaded.info.name},
                )

    def _unload(self, loaded: LoadedController) -> None:
        name = loaded.info.name
        users = [
            one.info.name
            for one in self.lifecycle.loaded
            if loaded in one.following or loaded in one.read
        ]
        if users:
            raise ControllerStateError(
                f"Controller '{name}' cannot be unloaded: its references or states are "
                f"claimed by {', '.join(users)}.",
                remedy=f"Unload {', '.join(users)} first.",
                details={"controller": name, "claimed_by": users},
            )
        if loaded.is_unreleased:
            raise ControllerStateError(
                f"Controller '{name}' cannot be unloaded: the robot could not be told "
                "that it has stopped, and may still be in its mode.",
                remedy=f"Stop '{name}' again, so that the robot is told again.",
                details={"controller": name, "state": loaded.controller.state.value},
            )
        # The ownership can be taken once: by this unloading, or by a fallback's start.
        owned = loaded.ownership.acquire(blocking=False)
        planned = name in self._switches.planned
        if not owned or planned or loaded.controller.is_running():
            if owned:
                loaded.ownership.release()
            raise ControllerStateError(
                f"Controller '{name}' cannot be unloaded: it is "
                f"{loaded.controller.state.value}.",
                remedy=f"Stop '{name}' first.",
                details={"controller": name, "state": loaded.controller.state.value},
            )
        self.lifecycle.loaded = tuple(
            one for one in self.lifecycle.loaded if one is not loaded
        )
        if loaded.beside is not None:
            loaded.beside.close()
