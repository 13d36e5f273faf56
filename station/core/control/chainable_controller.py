"""Controllers whose references other controllers command, as in a cascade.

Source: ros2_control@4.x controller_interface/chainable_controller_interface.hpp;
differs: a reference without an owner is put to rest instead of NaN; a preceding
controller claims references when it is loaded, not when it is activated; the mode of a
running controller changes without a restart.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from typing_extensions import override

from station.core.control.controller import MultiInterfaceController
from station.core.errors import refuse_non_number
from station.core.hardware.interfaces.joint import (
    EFFORT_START_JUMP,
    POSITION_START_JUMP,
    VELOCITY_START_JUMP,
)
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    check_storage,
)
from station.memory.doubles import Storage

_START_JUMPS = {
    "position": POSITION_START_JUMP,
    "velocity": VELOCITY_START_JUMP,
    "effort": EFFORT_START_JUMP,
}


def _no_reference() -> float:
    return 0.0


@dataclass(frozen=True, slots=True)
class Reference:
    """A value that a preceding controller may command: a reference interface.

    Attributes:
        name: Name without the controller's name, usually `joint/interface`, e.g.
            `joint1/position`.
        storage: The controller's own list; changed in place, never bound anew.
        index: Its slot in `storage`.
        rest: Returns the reference at which the controller lets the robot rest, in the
            unit of the reference; 0 by default. Called in the control thread.
    """

    name: str
    storage: Storage
    index: int = 0
    rest: Callable[[], float] = _no_reference


@dataclass(frozen=True, slots=True)
class ExportedState:
    """A value that other controllers may read: a state interface of a controller.

    Attributes:
        name: Name without the controller's name, usually `joint/interface`.
        storage: The controller's own list; changed in place, never bound anew.
        index: Its slot in `storage`.
    """

    name: str
    storage: Storage
    index: int = 0


class ReferenceHandle(ResourceHandle):
    """Commands one reference of another controller.

    Args:
        name: Full name, e.g. `pid_controller/joint1/position`.
        reference: The exported reference.

    Raises:
        HardwareInterfaceError: The storage has no such slot.
    """

    def __init__(self, name: str, reference: Reference) -> None:
        super().__init__(name)
        self.index = reference.index
        self.storage: Storage = check_storage(
            name, "Reference", reference.storage, reference.index
        )
        self.rest = reference.rest

    def get_command(self) -> float:
        """Return the reference commanded last."""
        return self.storage[self.index]

    def set_command(self, command: float) -> None:
        """Set the reference, in its unit.

        Raises:
            InvalidCommandError: The command is not a number.
        """
        try:
            self.storage[self.index] = command
        except TypeError:
            refuse_non_number(self.name, command)

    @override
    def command_slots(self) -> list[tuple[Storage, int]]:
        return [(self.storage, self.index)]


class ReferenceInterface(HardwareResourceManager[ReferenceHandle]):
    """References of loaded controllers; asking for a handle claims the reference.

    A reference of a joint of the robot can also be claimed through the joint's
    interface: `pid_controller/joint1` of `PositionJointInterface` is the reference
    `pid_controller/joint1/position`.
    """

    type_name: ClassVar[str] = "controller_interface::ReferenceInterface"
    claims_resources: ClassVar[bool] = True

    @override
    def rest_commands(self, name: str) -> list[float]:
        return [self._handles[name].rest()]

    @override
    def start_jump_limits(self, name: str) -> list[float]:
        return [_START_JUMPS.get(name.rpartition("/")[2], float("inf"))]


class ExportedStateHandle(ResourceHandle):
    """Reads one state that another controller exports.

    Args:
        name: Full name, e.g. `pid_controller/joint1/position`.
        state: The exported state.

    Raises:
        HardwareInterfaceError: The storage has no such slot.
    """

    def __init__(self, name: str, state: ExportedState) -> None:
        super().__init__(name)
        self.index = state.index
        self.storage: Storage = check_storage(name, "State", state.storage, state.index)

    def get_value(self) -> float:
        """Return the value, in its unit."""
        return self.storage[self.index]


class ExportedStateInterface(HardwareResourceManager[ExportedStateHandle]):
    """States that loaded controllers export; several controllers may read the same.

    A claim names a reader of the state, and gives no right to write it.
    """

    type_name: ClassVar[str] = "controller_interface::ExportedStateInterface"
    claims_resources: ClassVar[bool] = True


class ChainableController(MultiInterfaceController):
    """A controller that may follow another one.

    It exports references and states once, after `init`. It is in chained mode while a
    running controller claims its references: it then takes the values from the storage
    of its references, and must not change them. Otherwise
    `update_reference_from_subscribers` sets the references from set-points.

    A preceding controller is updated before the one that it commands, in the same
    cycle. When it stops, the references are put to rest and chained mode ends.

    Attributes:
        is_in_chained_mode: Whether a running controller commands the references; only
            the manager changes it.
    """

    def __init__(self) -> None:
        super().__init__()
        self.is_in_chained_mode = False

    def on_export_reference_interfaces(self) -> Sequence[Reference]:
        """Return the references that a preceding controller may command."""
        return ()

    def on_export_state_interfaces(self) -> Sequence[ExportedState]:
        """Return the states that other controllers may read."""
        return ()

    def on_set_chained_mode(self, chained_mode: bool) -> bool:  # noqa: FBT001, ARG002 - upstream's signature
        """Prepare for a change of the mode, in the control thread.

        Args:
            chained_mode: Whether a running controller commands the references.

        Returns:
            Whether the controller accepts the mode. If not, the preceding controller
            does not start.
        """
        return True

    def update_reference_from_subscribers(self, time: float, period: float) -> None:
        """Set the references from set-points; called outside of chained mode only.

        Args:
            time: Station time [s].
            period: Time since the last update [s], >= 0.
        """

    def update_and_write_commands(self, time: float, period: float) -> None:
        """Compute commands from the references and write them, in both modes.

        Args:
            time: Station time [s].
            period: Time since the last update [s], >= 0.
        """
        raise NotImplementedError

    @override
    def update(self, time: float, period: float) -> None:
        if not self.is_in_chained_mode:
            self.update_reference_from_subscribers(time, period)
        self.update_and_write_commands(time, period)

    def set_chained_mode(self, *, chained_mode: bool) -> bool:
        """Change the mode unless the controller objects; return whether it accepted."""
        if not self.on_set_chained_mode(chained_mode):
            return False
        self.is_in_chained_mode = chained_mode
        return True
