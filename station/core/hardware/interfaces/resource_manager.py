"""Named handles, the managers that hold and claim them, and registries of managers.

Source: ros_control@0.20.0 hardware_interface/internal/resource_manager.h,
hardware_resource_manager.h, hardware_interface.h, internal/interface_manager.h.
"""

import threading
from collections.abc import Iterable
from typing import ClassVar, Generic, TypeVar, cast

from typing_extensions import override

from station.core.errors import HardwareInterfaceError, ResourceNotFoundError, suggest
from station.memory.doubles import Storage

T = TypeVar("T")


class ResourceHandle:
    """A named view on a resource of the robot.

    Handles belong to the control thread: they read and write the robot's own lists of
    floats without a lock or a copy.

    Attributes:
        name: Name of the resource, unique within its interface.
    """

    def __init__(self, name: str) -> None:
        self.name = name

    def command_slots(self) -> list[tuple[Storage, int]]:
        """Return the places that this handle commands, as (storage, index) pairs.

        The controller manager checks these places in every cycle: a value that is not
        finite stops the controller that wrote it. A handle that only reads has no such
        place.
        """
        return []


StorageT = TypeVar("StorageT", bound=Storage)


def check_storage(
    name: str,
    what: str,
    storage: StorageT | None,
    index: int,
    kind: str = "data pointer",
) -> StorageT:
    """Return `storage` if it has the slot `index`.

    Args:
        name: Name of the resource.
        what: Name of the stored quantity in the error message.
        storage: The storage.
        index: The slot.
        kind: Word for the storage in the original's message.

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
    """A set of handles by name. The robot fills it, controllers read it.

    Attributes:
        type_name: Name on the wire, as ros_control writes it.
    """

    type_name: ClassVar[str] = ""

    def __init__(self) -> None:
        self._handles: dict[str, H] = {}

    def register_handle(self, handle: H) -> None:
        """Add `handle`, replacing one of the same name (CM-102)."""
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
                remedy=suggest(name, self.get_names()),
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

    Several controllers may be initialised at the same time, each in its own thread, and
    their claims must not mix.
    """

    def __init__(self) -> None:
        self.names: set[str] = set()


class HardwareResourceManager(ResourceManager[H]):
    """An interface between controllers and hardware: handles and claims.

    Subclasses choose the claim policy: with `claims_resources = True`, a controller
    that asks for a handle in its initialisation claims the resource.

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
        """Return the handle called `name`, and claim it if `claims_resources` is set.

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
        """Return the manager in which `name` was first registered.

        An interface that combines those of several robots returns the interface of the
        robot itself, because only that one knows the rest commands of its resources.
        """
        return self._origins.get(name, self)

    def claim(self, name: str) -> None:
        """Claim the resource `name` without returning its handle."""
        self._claims.names.add(name)

    def get_claims(self) -> list[str]:
        """Return the names claimed since the last `clear_claims`, sorted."""
        return sorted(self._claims.names)

    def clear_claims(self) -> None:
        """Forget all claims."""
        self._claims.names.clear()

    def rest_commands(self, name: str) -> list[float]:
        """Return the commands that let the resource `name` rest at its present place.

        There is one value per slot of the handle's `command_slots`. The manager writes
        them when a controller fails, and compares the first command of a started
        controller with them. Called in the control thread.
        """
        return [0.0 for _ in super().get_handle(name).command_slots()]

    def present_commands(self, name: str) -> list[float]:
        """Return the commands that continue the present motion of the resource `name`.

        There is one value per slot. A first command between rest and these values is
        not a jump. They equal `rest_commands` unless the resource may be in motion.
        """
        return self.rest_commands(name)

    def start_jump_limits(self, name: str) -> list[float]:
        """Return the largest distances of a first command from rest, one per slot.

        They are in the unit of the command, and infinite if any first command is
        allowed.
        """
        return [float("inf") for _ in super().get_handle(name).command_slots()]


def interface_type_name(interface_type: type) -> str:
    """Return the name of an interface type on the wire.

    It is the `type_name` of the class, such as `hardware_interface::…` for those of
    ros_control, or the qualified Python name of a class without `type_name`.
    """
    declared = getattr(interface_type, "type_name", "")
    return str(declared) or f"{interface_type.__module__}.{interface_type.__qualname__}"


class InterfaceManager:
    """Hold one object per interface type; several managers can be combined.

    Any object can be an interface, also the robot itself
    (`self.register_interface(self, MyInterface)`).
    """

    def __init__(self) -> None:
        self._interfaces: dict[type, object] = {}
        self._managers: list[InterfaceManager] = []
        self._combined: dict[type, tuple[int, object]] = {}

    def register_interface(
        self, interface: object, interface_type: type | None = None
    ) -> None:
        """Register `interface` under its type, replacing an earlier one (CM-101).

        Args:
            interface: The interface.
            interface_type: The type to register it under; None takes its own class.
        """
        self._interfaces[interface_type or type(interface)] = interface

    def register_interface_manager(self, manager: "InterfaceManager") -> None:
        """Let `get` also find the present and later interfaces of `manager`."""
        self._managers.append(manager)

    def get(self, interface_type: type[T]) -> T | None:
        """Return the interface of a type, or None if there is none.

        With several providers, the result is a new object that holds all their handles.
        It is kept until the number of providers changes (CM-107). The result is None if
        a provider is not a resource manager, because then it cannot be combined
        (CM-108).
        """
        providers = self._providers(interface_type)
        if not providers:
            return None
        if len(providers) == 1:
            return cast("T", providers[0])
        return cast("T | None", self._combine(interface_type, providers))

    def _providers(self, interface_type: type) -> list[object]:
        providers = []
        if interface_type in self._interfaces:
            providers.append(self._interfaces[interface_type])
        for manager in self._managers:
            provided: object | None = manager.get(interface_type)
            if provided is not None:
                providers.append(provided)
        return providers

    def _combine(self, interface_type: type, providers: list[object]) -> object | None:
        known = self._combined.get(interface_type)
        if known is not None and known[0] == len(providers):
            return known[1]
        managers = [p for p in providers if isinstance(p, ResourceManager)]
        if len(managers) != len(providers):
            return None
        combined: ResourceManager[ResourceHandle] = type(managers[0])()
        combined.merge(managers)
        self._combined[interface_type] = (len(providers), combined)
        return combined

    def interface_types(self) -> list[type[object]]:
        """Return every registered type once, in the order of registration."""
        types: list[type[object]] = list(self._interfaces)
        for manager in self._managers:
            types += [t for t in manager.interface_types() if t not in types]
        return types

    def get_names(self) -> list[str]:
        """Return the wire names of all interface types, each once."""
        return [interface_type_name(t) for t in self.interface_types()]

    def get_interface_resources(self, type_name: str) -> list[str]:
        """Return the resource names of the interface type named `type_name`.

        The names come provider by provider. The list is empty if the type is unknown or
        its interface holds no resources.
        """
        names: list[str] = []
        for interface_type in self.interface_types():
            if interface_type_name(interface_type) == type_name:
                for provider in self._providers(interface_type):
                    if isinstance(provider, ResourceManager):
                        names += provider.get_names()
        return names

    def resources(self) -> set[str]:
        """Return the names of all resources of all interfaces."""
        return {
            resource
            for type_name in self.get_names()
            for resource in self.get_interface_resources(type_name)
        }
