"""Named handles, the managers that hold them, and the two claim policies.

Source: ros_control@0.20.0 hardware_interface/internal/resource_manager.h,
hardware_resource_manager.h, hardware_interface.h.
"""

import threading
from collections.abc import Iterable
from typing import ClassVar, Generic, TypeVar

from typing_extensions import override

from station.core.errors import HardwareInterfaceError, ResourceNotFoundError


class ResourceHandle:
    """A named view on a resource of the robot.

    Handles live in the control thread: they read and write the robot's own lists
    of floats without a lock or a copy.

    Attributes:
        name: Name of the resource, unique within its interface.
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def command_slots(self) -> list[tuple[list[float], int]]:
        """Return the places this handle commands, as (storage, index) pairs.

        The controller manager watches them: a value that is not finite stops the
        controller that wrote it. Handles that only read return an empty list.
        """
        return []


def check_storage(
    name: str,
    what: str,
    storage: list[float] | None,
    index: int,
    kind: str = "data pointer",
) -> list[float]:
    """Return `storage` when it is a list that has the slot `index`.

    Args:
        name: Name of the resource.
        what: What the storage holds, as the error message says it.
        storage: The storage.
        index: The slot.
        kind: What the original calls the storage in its message.

    Raises:
        HardwareInterfaceError: The storage is None, or `index` is outside of it.
    """
    if storage is None:
        raise HardwareInterfaceError(
            f"Cannot create handle '{name}'. {what} {kind} is null.",
            remedy="Pass the list of floats in which the robot keeps this value.",
            details={"resource": name},
        )
    if not 0 <= index < len(storage):
        raise HardwareInterfaceError(
            f"Cannot create handle '{name}'. {what} index {index} is outside the "
            f"storage of {len(storage)} values.",
            remedy="Use one slot per joint, counted from 0.",
            details={"resource": name},
        )
    return storage


H = TypeVar("H", bound=ResourceHandle)


class ResourceManager(Generic[H]):
    """A set of handles by name. Filled by the robot, read by controllers.

    Attributes:
        type_name: Name on the wire, as ros_control demangles it.
    """

    type_name: ClassVar[str] = ""

    def __init__(self) -> None:
        self._handles: dict[str, H] = {}

    def register_handle(self, handle: H) -> None:
        """Add `handle`; one of the same name is replaced (CM-102)."""
        self._handles[handle.name] = handle

    def get_handle(self, name: str) -> H:
        """Return the handle called `name`.

        Raises:
            ResourceNotFoundError: No handle of that name is registered.
        """
        handle = self._handles.get(name)
        if handle is None:
            raise ResourceNotFoundError(
                f"Could not find resource '{name}' in '{self.type_name}'.",
                remedy=f"Known resources: {', '.join(self.get_names()) or 'none'}.",
                details={"resource": name, "hardware_interface": self.type_name},
            )
        return handle

    def get_names(self) -> list[str]:
        """Return the names of all handles, sorted (CM-105)."""
        return sorted(self._handles)

    def handles(self) -> list[H]:
        """Return all handles in the order in which they were registered."""
        return list(self._handles.values())

    def merge(self, managers: Iterable["ResourceManager[H]"]) -> None:
        """Register the handles of all `managers` here (CM-107)."""
        for manager in managers:
            for handle in manager.handles():
                self.register_handle(handle)


class _Claims(threading.local):
    """The names that this thread has claimed.

    Several controllers are initialised at once, each in a thread of its own: their
    claims must not mix.
    """

    def __init__(self) -> None:
        self.names: set[str] = set()


class HardwareResourceManager(ResourceManager[H]):
    """An interface between controllers and hardware: handles plus claims.

    Subclasses choose the claim policy: with `claims_resources = True` asking for a
    handle claims its resource for the controller under initialisation.

    Attributes:
        claims_resources: Whether `get_handle` claims the resource.
    """

    claims_resources: ClassVar[bool] = False

    def __init__(self) -> None:
        super().__init__()
        self._claims = _Claims()
        self._origins: dict[str, HardwareResourceManager[H]] = {}

    @override
    def get_handle(self, name: str) -> H:
        """Return the handle called `name`, claiming it if the policy says so.

        Raises:
            ResourceNotFoundError: No handle of that name is registered.
        """
        handle = super().get_handle(name)
        if self.claims_resources:
            self._claims.names.add(name)
        return handle

    @override
    def merge(self, managers: Iterable[ResourceManager[H]]) -> None:
        for manager in managers:
            super().merge([manager])
            if isinstance(manager, HardwareResourceManager):
                for name in manager.get_names():
                    self._origins[name] = manager.origin(name)

    def origin(self, name: str) -> "HardwareResourceManager[H]":
        """Return the manager in which `name` was registered at first.

        Another one only for an interface that combines those of several robots: the
        robot's own interface knows how its resources rest.
        """
        return self._origins.get(name, self)

    def claim(self, name: str) -> None:
        """Claim the resource `name` without asking for its handle."""
        self._claims.names.add(name)

    def get_claims(self) -> list[str]:
        """Return the names claimed since the last `clear_claims`, sorted."""
        return sorted(self._claims.names)

    def clear_claims(self) -> None:
        """Forget all claims."""
        self._claims.names.clear()

    def rest_commands(self, name: str) -> list[float]:
        """Return the commands that let the resource `name` rest where it is.

        One value per slot of the handle's `command_slots`. They are written for a
        controller that fails, and a started controller's first command is compared
        with them. Called in the control thread.
        """
        return [0.0 for _ in super().get_handle(name).command_slots()]

    def present_commands(self, name: str) -> list[float]:
        """Return the commands that let the resource `name` go on as it does.

        One value per slot; rest unless the resource may be in motion. What lies
        between rest and these is no jump.
        """
        return self.rest_commands(name)

    def start_jump_limits(self, name: str) -> list[float]:
        """Return how far a first command may be from rest, one per command slot.

        In the unit of the command; infinite where any first command is allowed.
        """
        return [float("inf") for _ in super().get_handle(name).command_slots()]
