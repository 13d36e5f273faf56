"""Hardware whose reads and writes run in a thread of their own, beside the cycle.

The control thread, and the code that asks the robot there, use private copies of states
and commands. In each cycle the control thread takes the states that the last call has
read. After the controllers it hands over the commands for the next call, which writes
them and then reads.

Source: ros2_control@6.x hardware_interface/src/hardware_component.cpp, trigger_read,
trigger_write, and doc/asynchronous_components.rst; differs: one call writes and then
reads, so that the states are as recent as possible.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar, TypeVar, cast

from typing_extensions import override

from station.core.errors import HardwareInterfaceError, StationError, SwitchRefusedError
from station.core.hardware.async_function import PROCESS, AsyncFunction, AsyncParams
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    interface_type_name,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    HardwareComponent,
    RobotHW,
    SwitchState,
)
from station.core.parameters import Parameters
from station.memory.doubles import Storage, doubles

T = TypeVar("T")


class PrivateRobotHW(RobotHW):
    """A robot whose handles point into private copies of states and commands.

    Args:
        hw: The robot.

    Attributes:
        views: Interfaces by type, over the copies; each is made when it is first used.
        uncopied: Interfaces that are not copied, because their handles may have
            functions.
    """

    uncopied: ClassVar[tuple[type, ...]] = ()

    def __init__(self, hw: RobotHW) -> None:
        super().__init__()
        self._hw = hw
        self._copies: dict[int, tuple[Storage, Storage]] = {}
        self.views: dict[type, HardwareResourceManager[Any]] = {}

    def refusal(self, interface_type: type) -> StationError:
        """Return the error for an interface that cannot be copied.

        Args:
            interface_type: The type of the interface.
        """
        raise NotImplementedError

    @override
    def get(self, interface_type: type[T]) -> T | None:
        found = self._hw.get(interface_type)
        if found is None:
            return None
        if interface_type not in self.views:
            if not isinstance(found, HardwareResourceManager):
                raise self.refusal(interface_type)
            view = type(found)()
            for handle in found.handles():
                view.register_handle(self._copy_handle(handle, interface_type))
            self.views[interface_type] = view
        return cast("T", self.views[interface_type])

    @override
    def interface_types(self) -> list[type[object]]:
        return self._hw.interface_types()

    def storages(self) -> tuple[tuple[Storage, Storage], ...]:
        """Return every storage with its private copy."""
        return tuple(self._copies.values())

    def _copy_handle(
        self, handle: ResourceHandle, interface_type: type
    ) -> ResourceHandle:
        private = copy.copy(handle)
        for name, value in vars(handle).items():
            inside = value[0] if isinstance(value, list) and value else None
            if isinstance(inside, list | memoryview):
                setattr(private, name, [self._copy(each) for each in value])
            elif isinstance(value, list | memoryview):
                setattr(private, name, self._copy(value))
            elif not isinstance(value, str | int | float | tuple | None) and not (
                interface_type in self.uncopied and callable(value)
            ):
                raise self.refusal(interface_type)
        return private

    def _copy(self, storage: Storage) -> Storage:
        # The real storage is kept as well, so that no other one gets its `id`.
        found = self._copies.get(id(storage))
        if found is None:
            private = [*storage] if isinstance(storage, list) else doubles(storage)
            found = self._copies[id(storage)] = (storage, private)
        return found[1]


class AsyncRobotHW(PrivateRobotHW):
    """Reads and writes a robot in a thread of its own.

    A simulated robot, and any robot while no thread runs the loop, is read and written
    in the cycle, because its world belongs to the control thread; its states still
    count after the declared cycles. So every run is the same.

    Args:
        hw: The robot, not yet initialised.
        params: Policy, cycles and time limit of the calls.

    Attributes:
        calls: The calls that write and read.
    """

    def __init__(self, hw: RobotHW, params: AsyncParams) -> None:
        super().__init__(hw)
        self.calls = AsyncFunction(type(hw).__name__, self._write_and_read, params)
        self.set_stepped(lambda: True)
        # Methods that need neither the copies nor the thread are the robot's own.
        for name in _OF_THE_ROBOT:
            setattr(self, name, getattr(hw, name))
        self._name = type(hw).__name__
        self._states: list[tuple[Storage, Storage, tuple[int, ...]]] = []
        self._commands: list[tuple[Storage, Storage, int]] = []
        self._switches: list[Callable[[], None]] = []
        self._has_failed = self._is_interrupted = self._was_read = False
        self._time = 0.0

    @classmethod
    def wrap(cls, hw: RobotHW, params: Parameters) -> RobotHW:
        """Return the robot, made asynchronous if its parameters say so.

        Args:
            hw: The robot, not yet initialised.
            params: The robot's namespace, which may have `is_async` and
                `async_parameters`.

        Raises:
            ParameterError: A value is impossible.
        """
        asynchronous = AsyncParams.read(params, set())
        if asynchronous is not None and asynchronous.has_process:
            PROCESS.refuse(params, "true", "false: a robot has a thread")
        return hw if asynchronous is None else cls(hw, asynchronous)

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Initialise the robot, and make the copies.

        Raises:
            HardwareInterfaceError: The robot has an interface that cannot be copied, or
                it paces the loop.
        """
        hw = self._hw
        self._name = hw_params.resolve("").rpartition("/")[2] or self._name
        hw.init(root_params, hw_params)
        if hw.robot_clock() is not None:
            raise self._refuse("it paces the control thread")
        slots: dict[int, set[int]] = {}
        for kind in hw.interface_types():
            self.get(kind)
            for handle in cast("HardwareResourceManager[Any]", hw.get(kind)).handles():
                for storage, index in handle.command_slots():
                    slots.setdefault(id(storage), set()).add(index)
        for real, private in self.storages():
            commanded = slots.get(id(real), set())
            states = tuple(n for n in range(len(real)) if n not in commanded)
            self._states.append((real, private, states))
            self._commands += [(real, private, index) for index in sorted(commanded)]

    @override
    def refusal(self, interface_type: type) -> StationError:
        return self._refuse(
            f"the handles of its interface '{interface_type_name(interface_type)}' "
            "read the robot itself, which then belongs to another thread"
        )

    def _refuse(self, why: str) -> StationError:
        return HardwareInterfaceError(
            f"'{self._name}' cannot be asynchronous: {why}.",
            remedy="Leave is_async out.",
            details={"robot": self._name},
        )

    def set_stepped(self, is_stepped: Callable[[], bool]) -> None:
        """Set the function that returns whether no thread runs the loop."""
        hw = self._hw
        self.calls.is_stepped = lambda: hw.simulated_world() is not None or is_stepped()

    @override
    def components(self) -> Sequence[HardwareComponent]:
        return [replace(one, robot=self) for one in self._hw.components()]

    @override
    def on_configure(self, component: str) -> None:
        """Configure the robot; before the first cycle, also read it."""
        self._hw.on_configure(component)
        # Otherwise controllers would start with zeros. It may block here.
        if not self._was_read:
            self._hw.read(0.0, 0.0)
            self._take_states()

    @override
    def read(self, time: float, period: float) -> None:
        """Take the states of the last call if they count from this cycle on.

        Raises:
            BaseException: Whatever the robot's `read` or `write` raised.
        """
        self._time, self._was_read = time, True
        calls = self.calls
        if period <= 0.0 and calls.is_stepped():
            # No time passes, but the simulated world may have been moved.
            self._hw.read(time, 0.0)
            self._take_states()
            return
        if calls.take_result(period):
            self._take_states()
        if calls.is_idle():
            self._carry_out_switches()
            self._is_interrupted = self._hw.is_interrupted()

    @override
    def write(self, time: float, period: float) -> None:
        """Begin a call with the commands of this cycle, if one is due."""
        if period > 0.0:
            self.calls.begin_call(time, self._hand_over_commands)

    def _write_and_read(self, time: float, period: float) -> None:
        self._hw.write(time, period)
        self._hw.read(time, period)

    def _take_states(self) -> None:
        for real, private, states in self._states:
            for index in states:
                private[index] = real[index]

    def _hand_over_commands(self) -> None:
        for real, private, index in self._commands:
            real[index] = private[index]

    def _is_silent(self) -> str | None:
        """Return the reason why the robot cannot be used now; None if it can."""
        if not self.calls.is_overdue(self._time):
            return None
        limit = self.calls.params.time_limit
        return f"the hardware '{self._name}' has not answered for {limit:g} s"

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Ask the robot whether the switch is possible.

        Raises:
            SwitchRefusedError: The robot refuses, or does not answer.
        """
        silent = self._is_silent()
        if start and silent is not None:
            raise SwitchRefusedError(
                f"The switch is not possible: {silent}.",
                remedy="Wait until it answers.",
            )
        self._hw.prepare_switch(start, stop)

    @override
    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Switch the robot at once, or at the end of the call under way."""
        self._has_failed = False
        self._switches.append(partial(self._hw.do_switch, tuple(start), tuple(stop)))
        if self.calls.is_idle():
            # An error of the last switch is raised, as without a thread.
            last = self._switches.pop()
            self._carry_out_switches()
            last()

    def _carry_out_switches(self) -> None:
        while self._switches:
            try:
                self._switches.pop(0)()
            except Exception:  # noqa: BLE001 - answered by `switch_result`
                self._has_failed = True

    def _result(self, of_the_robot: Callable[[], SwitchState]) -> SwitchState:
        if self._has_failed:
            return SwitchState.ERROR
        if self._switches or not self.calls.is_idle():
            return SwitchState.ONGOING
        return of_the_robot()

    @override
    def switch_result(self) -> SwitchState:
        return self._result(self._hw.switch_result)

    @override
    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:
        return self._result(partial(self._hw.switch_result_for, controller))

    @override
    def is_interrupted(self) -> bool:
        return self._is_interrupted or self.calls.is_overdue(self._time)

    @override
    def interruption_of(self, controller: ControllerInfo) -> str | None:
        silent = self._is_silent()
        if silent is not None:
            return silent if self._is_used_by(controller) else None
        # The robot is asked only while it is idle; the next cycles ask again.
        return self._hw.interruption_of(controller) if self.calls.is_idle() else None

    def _is_used_by(self, controller: ControllerInfo) -> bool:
        return any(
            resource in self._hw.get_interface_resources(claim.hardware_interface)
            for claim in controller.claimed_resources
            for resource in claim.resources
        )


_OF_THE_ROBOT = (
    "address",
    "check_for_conflict",
    "check_period",
    "clamps",
    "close",
    "get_interface_resources",
    "guards",
    "hold_commands",
    "joint_limits",
    "mode",
    "on_activate",
    "on_cleanup",
    "on_deactivate",
    "on_error",
    "on_shutdown",
    "repairs",
    "simulated_world",
    "transmissions",
    "unguarded",
)
