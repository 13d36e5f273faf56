"""The sources of controllers: tables, installed packages, or any Python class.

Source: ros_control@0.20.0 controller_manager/controller_loader_interface.h,
controller_loader.h; differs: a plugin is a Python class named `module:Class`.
"""

import importlib
import importlib.util
import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType

from typing_extensions import override

from station.core.control.controller import ControllerBase
from station.core.errors import (
    CONTAINED,
    ControllerLoadError,
    ControllerModuleRefusedError,
    ControllerTypeNotFoundError,
    describe,
    suggest,
)

Stamp = tuple[int, int]
"""Time of the last change [ns] and size [bytes] of a source file."""


class PluginModules:
    """Imports modules of controllers and notices when their files change.

    Python imports a module only once. Without this class, an edited controller would
    run its old code after it is unloaded and loaded again. Loaded controllers keep the
    class that they were made of.
    """

    def __init__(self) -> None:
        self._named: set[str] = set()
        self._stamps: dict[str, Stamp] = {}

    def load(self, name: str) -> ModuleType:
        """Return a module, read from its file if that has changed since the import.

        If other modules of the same package have changed, the module imports them anew,
        too.

        Raises:
            ImportError: There is no such module, or it cannot be imported.
        """
        package = _package(name)
        related = [one for one in self._stamps if _package(one) == package]
        changed = {one for one in related if self._has_changed(one)}
        self._forget(changed)
        # The file may be newer than what Python knows of its folder.
        if changed or name not in sys.modules:
            importlib.invalidate_caches()
        self._named.add(name)
        module = importlib.import_module(name)
        for one in _of_package(name):
            stamp = _stamp(one)
            if stamp is not None:
                self._stamps.setdefault(one, stamp)
        return module

    def forget(self) -> None:
        """Forget every module that was loaded, and its submodules."""
        inside = {
            one
            for one in sys.modules
            if any(one == name or one.startswith(f"{name}.") for name in self._named)
        }
        changed = {one for one in self._stamps if self._has_changed(one)}
        self._forget(inside | changed)
        self._named.clear()
        self._stamps.clear()

    def _has_changed(self, name: str) -> bool:
        return name in sys.modules and _stamp(name) != self._stamps[name]

    def _forget(self, names: set[str]) -> None:
        for name in names:
            self._stamps.pop(name, None)
            module = sys.modules.pop(name, None)
            path = getattr(module, "__file__", None)
            if path is not None:
                # Python takes compiled code for fresh when time (in seconds) and size
                # of the source agree, so it would miss a quick edit of the same size.
                with suppress(OSError, NotImplementedError):
                    Path(importlib.util.cache_from_source(path)).unlink()


def _package(name: str) -> str:
    return name.partition(".")[0]


def _of_package(name: str) -> list[str]:
    """Return the imported modules whose changes matter to `name`.

    These are all modules of the same package. For a module of the station itself only
    that module matters, because its package is the whole station.
    """
    package = _package(name)
    if package == _package(__name__):
        return [name]
    return [one for one in list(sys.modules) if _package(one) == package]


def _stamp(name: str) -> Stamp | None:
    path = getattr(sys.modules.get(name), "__file__", None)
    if path is None:
        return None
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


BASE_CLASS = "controller_interface::ControllerBase"
"""Name of the base class of every controller, as ros_control spells it."""

Target = str | type[ControllerBase]
"""An entry of a table: `module:Class`, or the class itself."""

_ORIGINS = {
    "ackermann_steering_controller": "ros_controllers (ros-controls/ros_controllers)",
    "four_wheel_steering_controller": "ros_controllers (ros-controls/ros_controllers)",
    "robot_controllers": "robot_controllers of Fetch (fetchrobotics/robot_controllers)",
    "pr2_mechanism_controllers": "pr2_controllers (PR2/pr2_controllers)",
    "robot_mechanism_controllers": "pr2_controllers (PR2/pr2_controllers)",
    "unitree_legged_control": "unitree_ros (unitreerobotics/unitree_ros)",
    "baxter_sim_controllers": "baxter_simulator (RethinkRobotics/baxter_simulator)",
    "scaled_controllers": "the scaled controllers of Universal Robots "
    "(UniversalRobots/Universal_Robots_ROS_scaled_controllers)",
    "ur_controllers": "ur_robot_driver (UniversalRobots/Universal_Robots_ROS_Driver)",
    "passthrough_controllers": "the passthrough controllers of Universal Robots "
    "(UniversalRobots/Universal_Robots_ROS_passthrough_controllers)",
    "industrial_robot_status_controller": "industrial_robot_status_controller "
    "(gavanderhoorn/industrial_robot_status_controller)",
}
"""For each package of ROS whose types this station lacks: where to find them."""


class ControllerLoader(ABC):
    """Creates controllers of the types it knows. Used outside of the control thread.

    Attributes:
        name: Base class that `list_controller_types` shows.
    """

    def __init__(self, name: str = BASE_CLASS) -> None:
        self.name = name

    @abstractmethod
    def declared_types(self) -> list[str]:
        """Return the types that the loader can create."""

    @abstractmethod
    def create(self, controller_type: str) -> ControllerBase | None:
        """Return a new controller, or None if the loader does not know the type.

        Raises:
            ControllerLoadError: The type is known but cannot be created.
        """

    def find_class(
        self,
        controller_type: str,  # noqa: ARG002 - for overrides
    ) -> type[ControllerBase] | None:
        """Return the class of a type, or None if the loader cannot name it.

        Args:
            controller_type: The type.

        Raises:
            ControllerLoadError: The type is known but cannot be imported.
        """
        return None

    def knows(self, controller_type: str) -> bool:
        """Return whether `create` should be tried for that type."""
        return controller_type in self.declared_types()

    def reload(self) -> None:
        """Forget imported code, so that the next `create` reads it anew.

        By default a loader has no code to forget.
        """
        return


class TableLoader(ControllerLoader):
    """Creates the types of a table; imports a module when it is first needed.

    Args:
        table: Type to `module:Class` or to the class itself, as a mapping or as pairs.
            If a type is there twice, the last pair counts (CM-31).
        name: Base class that `list_controller_types` shows.
    """

    def __init__(
        self,
        table: Mapping[str, Target] | Sequence[tuple[str, Target]],
        name: str = BASE_CLASS,
    ) -> None:
        super().__init__(name)
        self._table: dict[str, Target] = dict(table)
        self._modules = PluginModules()

    @override
    def declared_types(self) -> list[str]:
        return list(self._table)

    @override
    def create(self, controller_type: str) -> ControllerBase | None:
        found = self.find_class(controller_type)
        return None if found is None else found()

    @override
    def find_class(self, controller_type: str) -> type[ControllerBase] | None:
        target = self._table.get(controller_type)
        if target is None or not isinstance(target, str):
            return target
        return _find_class(controller_type, target, self._modules)

    @override
    def reload(self) -> None:
        self._modules.forget()


class EntryPointLoader(ControllerLoader):
    """Creates the types that installed packages offer in an entry point group.

    Args:
        group: The group; each entry is named by its type.
    """

    def __init__(self, group: str = "station.controllers") -> None:
        super().__init__()
        self._group = group
        self._read: TableLoader | None = None

    @property
    def _table(self) -> TableLoader:
        # Read on demand: it takes longer than everything else that a manager does at
        # the start, and the station's own controllers are found before.
        if self._read is None:
            found: list[EntryPoint] = list(entry_points(group=self._group))
            self._read = TableLoader([(entry.name, entry.value) for entry in found])
        return self._read

    @override
    def declared_types(self) -> list[str]:
        return self._table.declared_types()

    @override
    def create(self, controller_type: str) -> ControllerBase | None:
        return self._table.create(controller_type)

    @override
    def find_class(self, controller_type: str) -> type[ControllerBase] | None:
        return self._table.find_class(controller_type)

    @override
    def reload(self) -> None:
        if self._read is not None:
            self._read.reload()
            self._read = None


class ClassLoader(ControllerLoader):
    """Creates the class that a type written `module:Class` names.

    Importing a module runs its code, so a station for several users should limit the
    modules.

    Args:
        allowed: Modules that may be imported, with their submodules; any module when
            None.
    """

    def __init__(self, allowed: Collection[str] | None = None) -> None:
        super().__init__()
        self._allowed = None if allowed is None else frozenset(allowed)
        self._modules = PluginModules()

    @override
    def declared_types(self) -> list[str]:
        return []

    @override
    def knows(self, controller_type: str) -> bool:
        module, separator, name = controller_type.partition(":")
        return bool(module and separator and name.isidentifier())

    @override
    def create(self, controller_type: str) -> ControllerBase | None:
        module = controller_type.partition(":")[0]
        self._check_allowed(module, controller_type)
        return _find_class(controller_type, controller_type, self._modules)()

    def _check_allowed(self, module: str, controller_type: str) -> None:
        """Refuse a module that is not on the list.

        Raises:
            ControllerModuleRefusedError: The module is not allowed.
        """
        if self._allowed is None or not self._allowed.isdisjoint(_with_parents(module)):
            return
        listed = sorted(self._allowed)
        raise ControllerModuleRefusedError(
            f"Controllers of the module '{module}' may not be loaded: the module is "
            "not on the list of modules that this station imports.",
            remedy="Add the module to the list of allowed modules and start again.",
            details={"type": controller_type, "module": module, "allowed": listed},
        )

    @override
    def reload(self) -> None:
        self._modules.forget()


def _with_parents(module: str) -> list[str]:
    """Return a module and the packages around it."""
    parts = module.split(".")
    return [".".join(parts[: count + 1]) for count in range(len(parts))]


def default_loaders(
    table: Mapping[str, str], modules: Collection[str] | None = None
) -> list[ControllerLoader]:
    """Return the loaders of a station, in the order in which they are asked.

    The first one knows the types of `table`, the second one those of installed
    packages, and the last one types of the form `module:Class`.

    Args:
        table: Type to `module:Class`.
        modules: Modules that `module:Class` may name; any module when None.
    """
    return [TableLoader(table), EntryPointLoader(), ClassLoader(modules)]


def create_controller(
    loaders: Sequence[ControllerLoader], controller_type: str
) -> ControllerBase:
    """Return a new controller from the first loader that has one (CM-31).

    Args:
        loaders: The sources of controllers, asked in this order.
        controller_type: The type.

    Raises:
        ControllerTypeNotFoundError: No loader knows the type.
        ControllerLoadError: A loader knows it and cannot create it.
    """
    known = False
    for loader in loaders:
        if not loader.knows(controller_type):
            continue
        known = True
        controller = _create_with(loader, controller_type)
        if controller is not None:
            return controller
    types = sorted({name for loader in loaders for name in loader.declared_types()})
    if known:
        raise ControllerLoadError(
            f"No loader returned a controller of type '{controller_type}'.",
            remedy="Look at the loader that declares it.",
            details={"type": controller_type},
        )
    # In ROS the part before the slash names the package that has the plugin.
    package = controller_type.partition("/")[0]
    origin = f" It comes from {_ORIGINS[package]}." if package in _ORIGINS else ""
    raise ControllerTypeNotFoundError(
        f"No loader knows the controller type '{controller_type}'.{origin}",
        remedy=f"{suggest(controller_type, types)} Or write 'module:Class'.",
        details={"type": controller_type},
    )


def _create_with(
    loader: ControllerLoader, controller_type: str
) -> ControllerBase | None:
    try:
        return loader.create(controller_type)
    # This error says more than the general message below.
    except ControllerLoadError:
        raise
    except CONTAINED as error:
        raise _cannot_create(controller_type, error) from error


def _find_class(
    controller_type: str, target: str, modules: PluginModules
) -> type[ControllerBase]:
    module_name, _, class_name = target.partition(":")
    try:
        found: object = modules.load(module_name)
        # A class may be inside another one.
        for part in class_name.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError, SyntaxError) as error:
        raise _cannot_create(controller_type, error) from error
    if not (isinstance(found, type) and issubclass(found, ControllerBase)):
        raise ControllerLoadError(
            f"'{target}' is no controller: it does not derive from ControllerBase.",
            remedy="Derive it from Controller or MultiInterfaceController.",
            details={"type": controller_type},
        )
    return found


def _cannot_create(controller_type: str, error: BaseException) -> ControllerLoadError:
    return ControllerLoadError(
        f"A controller of type '{controller_type}' cannot be created: "
        f"{describe(error)}.",
        remedy="Correct its class or its constructor; the cause is above.",
        details={"type": controller_type},
    )
