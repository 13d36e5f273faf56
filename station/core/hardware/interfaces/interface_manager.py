"""A registry of hardware interfaces by type, which can include other registries.

Source: ros_control@0.20.0 hardware_interface/internal/interface_manager.h.
"""

from typing import TypeVar, cast

from station.core.hardware.interfaces.resource_manager import (
    ResourceHandle,
    ResourceManager,
)

T = TypeVar("T")


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
