"""The Python modules of controllers, read anew when their source has changed."""

import importlib
import importlib.util
import sys
from contextlib import suppress
from pathlib import Path
from types import ModuleType

Stamp = tuple[int, int]
"""Time of the last change [ns] and size [bytes] of a source file."""


class PluginModules:
    """Imports modules of controllers and notices when their files change.

    Without this an edited controller that is unloaded and loaded again would run its
    old code, because Python imports a module once. Controllers that are loaded keep the
    class they were made of.
    """

    def __init__(self) -> None:
        self._named: set[str] = set()
        self._stamps: dict[str, Stamp] = {}

    def load(self, name: str) -> ModuleType:
        """Return a module, read from its file if that has changed since the import.

        Other modules of the same package that have changed are forgotten, too, so that
        the module imports them anew.

        Raises:
            ImportError: There is no such module, or it cannot be imported.
        """
        changed = {one for one in self._stamps if self._has_changed(one)}
        self._forget({one for one in changed if _package(one) == _package(name)})
        self._named.add(name)
        module = importlib.import_module(name)
        for one in _of_package(name):
            stamp = _stamp(one)
            if stamp is not None:
                self._stamps.setdefault(one, stamp)
        return module

    def forget(self) -> None:
        """Forget every module that was loaded, and what is inside of it."""
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
                # Compiled code counts as fresh when time (in seconds) and size of the
                # source agree, so a quick edit of the same size would not be seen.
                with suppress(OSError, NotImplementedError):
                    Path(importlib.util.cache_from_source(path)).unlink()
        importlib.invalidate_caches()


def _package(name: str) -> str:
    return name.partition(".")[0]


def _of_package(name: str) -> list[str]:
    """Return the imported modules whose change matters to `name`.

    They are those of its package; of the station's own, which share a package with
    everything else, the module alone.
    """
    package = _package(name)
    # The station's own modules are never imported anew.
    if package == _package(__name__):
        return [name]
    return [one for one in list(sys.modules) if _package(one) == package]


def _stamp(name: str) -> Stamp | None:
    path = getattr(sys.modules.get(name), "__file__", None)
    if path is None:
        return None
    try:
        found = Path(path).stat()
    except OSError:
        return None
    # The size finds a second change within the resolution of the time.
    return found.st_mtime_ns, found.st_size
