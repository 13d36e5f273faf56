"""Updates in a thread of their own, beside a cycle that never waits for them.

An asynchronous controller has private copies of the states and commands that it uses.
The control thread copies the states of a cycle before an update, and the commands when
the update has ended; in between the commands of before stay in force.

Source: ros2_control@4.x controller_interface_base.cpp, trigger_update, and
realtime_tools async_function_handler.hpp; differs: an update sees the states of one
cycle; its result counts from a declared number of cycles later; an update that does not
end stops its controller; nobody waits for an update when its controller stops.
"""

import copy
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from typing_extensions import override

from station.core.control.chainable_controller import (
    ExportedStateInterface,
    ReferenceInterface,
)
from station.core.control.controller import ControllerBase
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.errors import ControllerLoadError, ControllerStateError
from station.core.faults import CONTAINED
from station.core.hardware.interfaces.interface_manager import interface_type_name
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
)
from station.core.hardware.robot_hw import InterfaceResources, RobotHW
from station.core.numerics.statistics import DurationRing
from station.core.parameters import Parameters
from station.memory.doubles import Storage, doubles
from station.memory.wall_time import wall_time
from station.reports import AsyncStatistics

T = TypeVar("T")
IS_ASYNC = DeclaredParameter(
    name="is_async",
    type=ParameterType.BOOLEAN,
    default=False,
    description="update it in a thread of its own, beside the loop",
)
POLICY = DeclaredParameter(
    name="async_parameters/scheduling_policy",
    type=ParameterType.STRING,
    default="synchronized",
    choices=("synchronized", "detached"),
    description="when the result of an asynchronous update counts",
)
CYCLES = DeclaredParameter(
    name="async_parameters/cycles",
    type=ParameterType.NUMBER,
    default=1.0,
    minimum=1.0,
    description="after how many cycles the result of an asynchronous update counts",
)
TIME_LIMIT = DeclaredParameter(
    name="async_parameters/time_limit",
    type=ParameterType.NUMBER,
    unit="s",
    default=1.0,
    minimum=0.0,
    excludes_minimum=True,
    description="an asynchronous update that takes longer stops the controller",
)
_WITHOUT_EFFECT = (
    "thread_priority",
    "cpu_affinity",
    "execution_rate",
    "wait_until_initial_trigger",
    "print_warnings",
)
"""What files of ROS 2 may have in `async_parameters`; the rate is `update_rate`."""


@dataclass(frozen=True, slots=True)
class AsyncParams:
    """The parameters of an asynchronous controller.

    Attributes:
        is_detached: Whether a result counts as soon as it is there.
        cycles: After how many cycles the result of an update counts, >= 1.
        time_limit: How long an update may take [s station time], > 0.
    """

    is_detached: bool
    cycles: int
    time_limit: float

    @classmethod
    def read(cls, params: Parameters, reads: set[str]) -> "AsyncParams | None":
        """Return the parameters of a controller; None if it is not asynchronous.

        Args:
            params: The namespace.
            reads: Gets the names that files of ROS 2 have and that have no effect.

        Raises:
            ParameterError: A value is impossible.
        """
        # All are read, so that an impossible value is refused before it has an effect.
        policy, cycles = POLICY.read_str(params), CYCLES.read_float(params)
        time_limit = TIME_LIMIT.read_float(params)
        if not IS_ASYNC.read_bool(params):
            return None
        reads |= {
            params.resolve(f"async_parameters/{each}") for each in _WITHOUT_EFFECT
        }
        return cls(policy == "detached", int(cycles), time_limit)


class PrivateRobotHW(RobotHW):
    """The robot with private copies of states and commands, for one controller's init.

    Args:
        hw: The robot.
    """

    def __init__(self, hw: RobotHW) -> None:
        super().__init__()
        self._hw = hw
        self._copies: dict[int, tuple[Storage, Storage]] = {}
        self._views: dict[type, HardwareResourceManager[Any]] = {}

    @override
    def get(self, interface_type: type[T]) -> T | None:
        found = self._hw.get(interface_type)
        if found is None:
            return None
        if interface_type not in self._views:
            if not isinstance(found, HardwareResourceManager):
                raise _not_private(interface_type)
            view = type(found)()
            for handle in found.handles():
                view.register_handle(self._copy_handle(handle, interface_type))
            self._views[interface_type] = view
        return cast("T", self._views[interface_type])

    @override
    def interface_types(self) -> list[type[object]]:
        return self._hw.interface_types()

    def undeclared_claims(self) -> tuple[InterfaceResources, ...]:
        """Return claims of references and states whose interfaces are not declared."""
        return tuple(
            InterfaceResources(interface_type_name(kind), tuple(view.get_claims()))
            for kind, view in self._views.items()
            if kind in {ReferenceInterface, ExportedStateInterface}
        )

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
                # A reference's rest is the manager's business.
                interface_type is ReferenceInterface and callable(value)
            ):
                raise _not_private(interface_type)
        return private

    def _copy(self, storage: Storage) -> Storage:
        # The real one is kept with its copy, so that its identity stays its own.
        found = self._copies.get(id(storage))
        if found is None:
            private = [*storage] if isinstance(storage, list) else doubles(storage)
            found = self._copies[id(storage)] = (storage, private)
        return found[1]


def _not_private(interface_type: type) -> ControllerLoadError:
    return ControllerLoadError(
        f"Interface '{interface_type_name(interface_type)}' cannot be used by an "
        "asynchronous controller: its handles read the robot itself, which belongs to "
        "the control thread.",
        remedy="Leave is_async out, or use interfaces of joints and sensors.",
    )


class AsyncUpdate:
    """Updates one controller in a thread of its own.

    Takes the place of the controller's callbacks. All methods but `_run` and
    `statistics` are for the control thread.

    Args:
        controller: The controller, initialised over private copies.
        params: How it is updated.
        storages: Every storage that it uses, with its private copy.
        outputs: (storage, index) of the commands that it has claimed.

    Attributes:
        every: It is updated in every so manieth cycle, >= 1.
        is_stepped: Returns whether no thread runs the loop. An update is then carried
            out at once, and counts after the declared cycles.
    """

    def __init__(
        self,
        controller: ControllerBase,
        params: AsyncParams,
        storages: tuple[tuple[Storage, Storage], ...],
        outputs: list[tuple[Storage, int]],
    ) -> None:
        self.every = 1
        self.is_stepped: Callable[[], bool] = lambda: True
        self._params = params
        self._storages = storages
        private = {id(real): copied for real, copied in storages}
        self._outputs = [
            (storage, private[id(storage)], index) for storage, index in outputs
        ]
        self._last = [0.0 for _ in outputs]
        self._callbacks = (
            controller.starting,
            controller.update,
            controller.stopping,
            controller.aborting,
        )
        controller.starting = self.starting  # type: ignore[method-assign]
        controller.update = self.update  # type: ignore[method-assign]
        controller.stopping = self.stopping  # type: ignore[method-assign]
        controller.aborting = self.aborting  # type: ignore[method-assign]
        # A thread and what wakes it, for as long as the controller runs.
        self._go: threading.Lock | None = None
        self._run_number = 0
        self._name = type(controller).__name__
        # The update under way: its time and period, and what is owed after its end.
        self._job = (0.0, 0.0)
        self._is_busy = self._is_ending = False
        self._owed: deque[tuple[Callable[[float], None], float]] = deque()
        self._error: BaseException | None = None
        self._in_flight = False
        self._waited = self._countdown = 0
        self._elapsed = 0.0
        self._age = self._missed = 0
        self._durations, self._periods = DurationRing(1024), DurationRing(1024)

    def statistics(self) -> AsyncStatistics:
        """Return periods and durations of its updates. Any thread."""
        return AsyncStatistics(
            "detached" if self._params.is_detached else "synchronized",
            self._age,
            self._missed,
            self._durations.percentiles(),
            self._periods.percentiles(),
        )

    def end_thread(self) -> None:
        """End the thread, after the update under way; another update makes a new one.

        In the control thread, or while no thread runs the loop.
        """
        self._run_number += 1
        go, self._go = self._go, None
        if go is not None and not self._is_busy:
            go.release()

    def starting(self, time: float) -> None:
        """Start the controller, on the states of this cycle.

        Raises:
            ControllerStateError: The last update of the run before has not ended.
        """
        if self._is_busy or self._is_ending:
            raise ControllerStateError(
                "The update that was under way when it stopped has not ended.",
                remedy="Start it again when the update has ended.",
            )
        self._in_flight, self._error = False, None
        self._waited = self._countdown = self._age = 0
        self._elapsed = 0.0
        self._call_at_once(self._callbacks[0], time)
        self._take_results()

    def stopping(self, time: float) -> None:
        """Stop the controller; while an update is under way, after its end."""
        self._end(self._callbacks[2], time)

    def aborting(self, time: float) -> None:
        """Abort the controller; while an update is under way, after its end."""
        self._end(self._callbacks[3], time)

    def update(self, time: float, period: float) -> None:
        """Take the result of an update that has ended, and begin the next one.

        Raises:
            TimeoutError: The update under way takes longer than the time limit.
            BaseException: Whatever the update raised.
        """
        self._age += 1
        self._elapsed += period
        self._countdown -= 1
        if self._in_flight:
            self._waited += 1
            self._finish(time)
        if self._countdown <= 0:
            if not self._in_flight:
                self._countdown = self.every
                self._begin(time)
            elif not self._params.is_detached:
                # The trigger finds it busy, and comes again in its turn.
                self._missed += 1
                self._countdown = self.every
        # The robot may have limited the commands in place; it goes on from these.
        for (storage, _, index), value in zip(self._outputs, self._last, strict=True):
            storage[index] = value

    def _finish(self, time: float) -> None:
        if self._is_busy:
            if time - self._job[0] > self._params.time_limit:
                raise TimeoutError(
                    f"its update takes longer than {self._params.time_limit:g} s"
                )
            return
        is_early = self._params.is_detached and not self.is_stepped()
        if self._waited < self._params.cycles and not is_early:
            return
        self._in_flight = False
        error, self._error = self._error, None
        if error is not None:
            raise error
        self._age = self._waited
        self._take_results()

    def _begin(self, time: float) -> None:
        self._copy_states()
        self._job, self._elapsed = (time, self._elapsed), 0.0
        self._periods.add(self._job[1])
        self._in_flight, self._waited, self._is_busy = True, 0, True
        if self.is_stepped():
            self._update()
            return
        go = self._go
        if go is None:
            go = self._go = threading.Lock()
            go.acquire()
            threading.Thread(
                target=self._run,
                args=(go, self._run_number),
                name=f"async {self._name}",
                daemon=True,
            ).start()
        go.release()

    def _run(self, go: threading.Lock, run_number: int) -> None:
        while run_number == self._run_number:
            go.acquire()
            # It is also woken to end.
            if self._is_busy:
                self._update()

    def _update(self) -> None:
        begin = wall_time()
        try:
            self._callbacks[1](*self._job)
        except CONTAINED as error:  # raised again in the control thread
            self._error = error
        self._durations.add(wall_time() - begin)
        # In this order: whatever is owed later finds that nothing is under way.
        self._is_ending = True
        self._is_busy = False
        if self._owed:
            # Results and faults of a controller that has stopped are void.
            with suppress(*CONTAINED, IndexError):
                callback, time = self._owed.pop()
                callback(time)
        self._is_ending = False

    def _end(self, callback: Callable[[float], None], time: float) -> None:
        self._in_flight = False
        self._owed.append((callback, time))
        self.end_thread()
        if self._is_busy:
            return  # its thread calls it
        try:
            self._owed.pop()
        except IndexError:
            return  # its thread has just ended, and calls it
        self._call_at_once(callback, time)
        self._take_results()

    def _call_at_once(self, callback: Callable[[float], None], time: float) -> None:
        self._copy_states()
        callback(time)

    def _copy_states(self) -> None:
        for real, private in self._storages:
            private[:] = real  # type: ignore[assignment]

    def _take_results(self) -> None:
        for place, (storage, private, index) in enumerate(self._outputs):
            self._last[place] = private[index]
            storage[index] = private[index]
