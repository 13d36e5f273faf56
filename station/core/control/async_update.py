"""Controllers whose updates run in threads of their own, beside the cycle.

An asynchronous controller has private copies of the states and commands that it uses.
The control thread copies the states of a cycle into them before an update, and the
commands out of them when the update has ended; until then the robot keeps the commands
of the last update.

Source: ros2_control@4.x controller_interface_base.cpp, trigger_update; differs: an
update sees the states of one cycle; an update that does not end stops its controller.
"""

from collections.abc import Callable
from functools import partial

from typing_extensions import override

from station.core.control.chainable_controller import (
    ExportedStateInterface,
    ReferenceInterface,
)
from station.core.control.controller import ControllerBase
from station.core.errors import ControllerLoadError, ControllerStateError, StationError
from station.core.hardware.async_function import AsyncFunction, AsyncParams
from station.core.hardware.async_robot_hw import PrivateRobotHW
from station.core.hardware.interfaces.resource_manager import interface_type_name
from station.core.hardware.robot_hw import InterfaceResources
from station.memory.doubles import Storage


class ControllerHW(PrivateRobotHW):
    """The robot with private copies of states and commands, for one controller's init.

    Args:
        hw: The robot.
    """

    # Only the manager calls the rest function of a reference, so it is not copied.
    uncopied = (ReferenceInterface,)

    def undeclared_claims(self) -> tuple[InterfaceResources, ...]:
        """Return claims of references and states whose interfaces are not declared."""
        return tuple(
            InterfaceResources(interface_type_name(kind), tuple(view.get_claims()))
            for kind, view in self.views.items()
            if kind in {ReferenceInterface, ExportedStateInterface}
        )

    @override
    def refusal(self, interface_type: type) -> StationError:
        return ControllerLoadError(
            f"Interface '{interface_type_name(interface_type)}' cannot be used by an "
            "asynchronous controller: its handles read the robot itself, which belongs "
            "to the control thread.",
            remedy="Leave is_async out, or use interfaces of joints and sensors.",
        )


class AsyncUpdate(AsyncFunction):
    """Updates one controller in a thread of its own.

    Its methods take the place of the controller's callbacks. All but `statistics` are
    for the control thread.

    Args:
        controller: The controller, initialised over private copies.
        params: Policy, cycles and time limit of the updates.
        storages: Every storage that the controller uses, with its private copy.
        outputs: (storage, index) of the commands that the controller has claimed.
    """

    def __init__(
        self,
        controller: ControllerBase,
        params: AsyncParams,
        storages: tuple[tuple[Storage, Storage], ...],
        outputs: list[tuple[Storage, int]],
    ) -> None:
        super().__init__(type(controller).__name__, controller.update, params)
        self._storages = storages
        private = {id(real): copied for real, copied in storages}
        self._outputs = [
            (storage, private[id(storage)], index) for storage, index in outputs
        ]
        self._last = [0.0 for _ in outputs]
        self._change: Callable[[], None] | None = None
        controller.tunables.when_idle = self._change_when_idle
        self._starting = controller.starting
        self._ends = (controller.stopping, controller.aborting)
        controller.starting = self.starting  # type: ignore[method-assign]
        controller.update = self.update  # type: ignore[method-assign]
        controller.stopping = self.stopping  # type: ignore[method-assign]
        controller.aborting = self.aborting  # type: ignore[method-assign]

    def close(self) -> None:
        """End the thread and the process; called when the controller is unloaded."""

    def starting(self, time: float) -> None:
        """Start the controller with the states of this cycle.

        Raises:
            ControllerStateError: The last update of the previous run has not ended.
        """
        if not self.is_idle():
            raise ControllerStateError(
                "The update that was under way when it stopped has not ended.",
                remedy="Start it again when the update has ended.",
            )
        self.begin_anew()
        self._call_at_once(self._starting, time)

    def stopping(self, time: float) -> None:
        """Stop the controller at once, or at the end of the update under way."""
        self._end_with(self._ends[0], time)

    def aborting(self, time: float) -> None:
        """Abort the controller at once, or at the end of the update under way."""
        self._end_with(self._ends[1], time)

    def update(self, time: float, period: float) -> None:
        """Take the result of an update that has ended, and begin the next one.

        Raises:
            TimeoutError: The update under way takes longer than the time limit.
            BaseException: Whatever the update raised.
        """
        if self.is_overdue(time):
            raise TimeoutError(
                f"its update takes longer than {self.params.time_limit:g} s"
            )
        if self.take_result(period):
            self._take_commands()
        self.begin_call(time, self._copy_states)
        # The robot may have limited the commands in place: write the unlimited ones.
        for (storage, _, index), value in zip(self._outputs, self._last, strict=True):
            storage[index] = value

    def _end_with(self, callback: Callable[[float], None], time: float) -> None:
        if self.end(partial(callback, time)):
            self._call_at_once(callback, time)

    def _call_at_once(self, callback: Callable[[float], None], time: float) -> None:
        self._copy_states()
        callback(time)
        self._take_commands()

    def _change_when_idle(self, change: Callable[[], None]) -> None:
        # An update under way must not see some values from before the change and
        # some from after it.
        if self.is_idle():
            change()
        else:
            self._change = change

    def _copy_states(self) -> None:
        change, self._change = self._change, None
        if change is not None:
            change()
        for real, private in self._storages:
            private[:] = real  # type: ignore[assignment]

    def _take_commands(self) -> None:
        for place, (storage, private, index) in enumerate(self._outputs):
            self._last[place] = private[index]
            storage[index] = private[index]
