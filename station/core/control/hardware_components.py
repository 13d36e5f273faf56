"""The life cycle of hardware components, which decides who may command them.

    unconfigured ── on_configure ──▶ inactive ── on_activate ──▶ active
                 ◀── on_cleanup ───           ◀── on_deactivate ─
    from any of them on_shutdown leads to finalized, from which nothing leads back

Source: ros2_control@6.x hardware_interface/doc/lifecycle_of_a_hardware_component.rst,
src/resource_manager.cpp, ResourceManager::set_component_state; differs: a component
that running controllers command is not deactivated.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import Enum

from station.core.errors import (
    CONTAINED,
    HardwareComponentError,
    HardwareComponentNotFoundError,
    ParameterError,
    StationError,
    describe,
    reason_of,
    suggest,
)
from station.core.hardware.async_robot_hw import AsyncRobotHW
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    interface_type_name,
)
from station.core.hardware.robot_hw import ControllerInfo, HardwareComponent, RobotHW
from station.core.parameters import Parameters
from station.reports import ComponentInterface, HardwareComponentReport

INITIAL_STATE = "hardware_components_initial_state"
"""Parameter that names the components that do not begin as active."""


class ComponentState(Enum):
    """The state of a hardware component."""

    UNCONFIGURED = "unconfigured"
    INACTIVE = "inactive"
    ACTIVE = "active"
    FINALIZED = "finalized"


_ORDER = (ComponentState.UNCONFIGURED, ComponentState.INACTIVE, ComponentState.ACTIVE)
_UP = ("on_configure", "on_activate")
_DOWN = ("on_cleanup", "on_deactivate")


class _LiveComponent:
    """A component and its present state.

    Attributes:
        offers_commands: Whether controllers that command it may start.
        problem: The last error of a hook.
    """

    def __init__(self, component: HardwareComponent) -> None:
        self.component = component
        self.state = ComponentState.UNCONFIGURED
        self.offers_commands = False
        self.problem = ""

    def has(self, hardware_interface: str, resource: str) -> bool:
        """Return whether a resource belongs to the component."""
        one = self.component
        if one.resources is not None and resource not in one.resources:
            return False
        return resource in one.robot.get_interface_resources(hardware_interface)

    def steps(self, target: ComponentState) -> list[tuple[str, ComponentState]]:
        """Return the hooks that lead to another state, each with the state after it.

        Raises:
            HardwareComponentError: The component is finalized.
        """
        if self.state is target:
            return []
        if self.state is ComponentState.FINALIZED:
            raise HardwareComponentError(
                f"Hardware component '{self.component.name}' is finalized: it was shut "
                "down, or its on_error failed.",
                remedy="Start the station again.",
                details={"component": self.component.name, "state": "finalized"},
            )
        if target is ComponentState.FINALIZED:
            return [("on_shutdown", target)]
        here, there = _ORDER.index(self.state), _ORDER.index(target)
        if here < there:
            return [(_UP[n], _ORDER[n + 1]) for n in range(here, there)]
        return [(_DOWN[n - 1], _ORDER[n - 1]) for n in range(here, there, -1)]

    def carry_out(self, hook: str, after: ComponentState) -> None:
        """Call a hook; the component then has the state `after`.

        Raises:
            HardwareComponentError: The hook refuses or fails.
        """
        robot, key = self.component.robot, self.component.key or self.component.name
        try:
            getattr(robot, hook)(key)
        except StationError as error:
            self.problem = error.message
            raise self._failed(hook, error.message, error.remedy) from error
        except CONTAINED as error:  # shown with the component
            self.problem = reason_of(hook, error)
            self.state = ComponentState.UNCONFIGURED
            try:
                robot.on_error(key, self.problem)
            except CONTAINED as worse:  # shown with the component
                self.problem += f"; {reason_of('on_error', worse)}"
                self.state = ComponentState.FINALIZED
            raise self._failed(hook, describe(error), "Look at the robot.") from error
        self.state, self.problem = after, ""

    def _failed(self, hook: str, why: str, remedy: str) -> HardwareComponentError:
        name, state = self.component.name, self.state.value
        return HardwareComponentError(
            f"Hardware component '{name}' is {state}: {hook} failed: {why}",
            remedy=remedy,
            details={"component": name, "state": state, "hook": hook},
        )


class HardwareComponents:
    """The components of a robot and their states.

    Args:
        hw: The robot, initialised.
    """

    def __init__(self, hw: RobotHW) -> None:
        self._live = {one.name: _LiveComponent(one) for one in hw.components()}
        self._all_active = False

    def begin(self, params: Parameters) -> None:
        """Bring all components into their first states; before the first cycle.

        Args:
            params: The namespace that may have `hardware_components_initial_state`,
                with lists of names for `unconfigured` and `inactive`.

        Raises:
            HardwareComponentError: A hook refuses or fails.
            ParameterError: A name or a state is unknown.
        """
        initial = params.namespace(INITIAL_STATE)
        wanted = dict.fromkeys(self._live, ComponentState.ACTIVE)
        for key in initial.keys():  # noqa: SIM118 - no mapping
            # In ROS 2 this flag decides whether a failing hook shuts the manager down;
            # here such a hook always ends the start.
            if key == "shutdown_on_initial_state_failure":
                continue
            states = {one.value: one for one in _ORDER}
            if key not in states:
                raise ParameterError(
                    f"Parameter '{initial.resolve(key)}' is no state of hardware.",
                    remedy=f"States are {', '.join(states)}.",
                    details={"parameter": initial.resolve(key)},
                )
            for name in initial.get_str_list(key):
                wanted[self._find(name).component.name] = states[key]
        for name, state in wanted.items():
            self.change(name, state)

    def change(
        self,
        name: str,
        target: ComponentState,
        running: Callable[[], Sequence[ControllerInfo]] = tuple,
    ) -> None:
        """Bring a component into another state. Not for the control thread.

        Args:
            name: Name of the component.
            target: The new state; hooks on the way are called in their order.
            running: Returns the running controllers.

        Raises:
            HardwareComponentNotFoundError: There is no such component.
            HardwareComponentError: It is in use or finalized, or a hook refuses.
        """
        live = self._find(name)
        steps = live.steps(target)
        if not steps:
            return
        leaves = live.state is ComponentState.ACTIVE
        # From here on no controller starts, nor does a fallback: both check this.
        live.offers_commands = self._all_active = False
        try:
            users = self.users(name, running()) if leaves else []
            if users:
                raise HardwareComponentError(
                    f"Hardware component '{name}' is in use by {', '.join(users)}.",
                    remedy="Stop them first, or let them be stopped "
                    "(stop_controllers).",
                    details={"component": name, "state": "active", "users": users},
                )
            for hook, after in steps:
                live.carry_out(hook, after)
        finally:
            live.offers_commands = live.state is ComponentState.ACTIVE
            self._all_active = all(one.offers_commands for one in self._live.values())

    def users(self, name: str, controllers: Sequence[ControllerInfo]) -> list[str]:
        """Return the names of the given controllers that command a component.

        Args:
            name: The component.
            controllers: The running controllers.
        """
        live = self._find(name)
        return [info.name for info in controllers if _commands(live, info)]

    def refusal(self, info: ControllerInfo) -> str | None:
        """Return the reason why a controller cannot start; None if it can.

        Any thread.
        """
        if self._all_active:
            return None
        for live in self._live.values():
            resource = None if live.offers_commands else _commands(live, info)
            if resource is not None:
                return (
                    f"it commands '{resource}' of the hardware component "
                    f"'{live.component.name}', which is {live.state.value}"
                )
        return None

    def report(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[HardwareComponentReport]:
        """Return all components with their interfaces. Any thread.

        Args:
            controllers: The running controllers.
        """
        claims: dict[tuple[str, str], list[str]] = {}
        for info in controllers:
            for claim in info.claimed_resources:
                for resource in claim.resources:
                    key = (claim.hardware_interface, resource)
                    claims.setdefault(key, []).append(info.name)
        return [_report(live, claims) for live in self._live.values()]

    def _find(self, name: str) -> _LiveComponent:
        live = self._live.get(name)
        if live is None:
            raise HardwareComponentNotFoundError(
                f"There is no hardware component '{name}'.",
                remedy=suggest(name, self._live),
                details={"component": name},
            )
        return live


def _commands(live: _LiveComponent, info: ControllerInfo) -> str | None:
    """Return a resource of the component that a controller claims; None if none."""
    for claim in info.claimed_resources:
        for resource in claim.resources:
            if live.has(claim.hardware_interface, resource):
                return resource
    return None


def _report(
    live: _LiveComponent, claims: Mapping[tuple[str, str], Sequence[str]]
) -> HardwareComponentReport:
    component, robot = live.component, live.component.robot
    is_readable = live.state in _ORDER[1:]
    found: dict[bool, list[ComponentInterface]] = {True: [], False: []}
    for kind in robot.interface_types():
        if not issubclass(kind, HardwareResourceManager):
            continue
        name = interface_type_name(kind)
        for resource in robot.get_interface_resources(name):
            if component.resources is None or resource in component.resources:
                is_command = kind.claims_resources
                found[is_command].append(
                    ComponentInterface(
                        name,
                        resource,
                        live.offers_commands if is_command else is_readable,
                        tuple(claims.get((name, resource), ())),
                    )
                )
    return HardwareComponentReport(
        component.name,
        component.type,
        component.plugin,
        live.state.value,
        live.problem,
        tuple(found[True]),
        tuple(found[False]),
        robot.calls.statistics() if isinstance(robot, AsyncRobotHW) else None,
    )
