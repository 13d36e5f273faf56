"""Find the modules that are compiled: all their extensions, or all their sources.

Every import of the station passes through this module, so it imports `station.compiled`
only when a compiled module is asked for.
"""

import os
from collections.abc import Sequence
from importlib.machinery import (
    EXTENSION_SUFFIXES,
    ExtensionFileLoader,
    ModuleSpec,
    SourceFileLoader,
)
from importlib.util import spec_from_file_location
from types import ModuleType

SHARED = "station.memory.shared_by_all"
"""Module with Cython's own functions, compiled once instead of into each extension."""
SUFFIX = EXTENSION_SUFFIXES[0]
"""Ending of the file of an extension for this version of Python only."""


class CompiledFinder:
    """Finds the modules that are compiled: all their extensions, or all their sources.

    Python itself would load any extension that lies beside a source, even a stale one.
    """

    def __init__(self) -> None:
        self._stamps: dict[str, int] = {}

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,  # noqa: ARG002 - the protocol's
    ) -> ModuleSpec | None:
        """Return the location of a compiled module; None for every other module.

        Raises:
            ImportError: The extension was rebuilt after this process had decided to run
                extensions.
        """
        if path is None or not fullname.startswith("station."):
            return None
        stem = os.path.join(next(iter(path)), fullname.rpartition(".")[2])
        if fullname != SHARED and not os.path.exists(f"{stem}.pxd"):
            return None
        from station import compiled

        if not compiled.status().is_compiled:
            loader = SourceFileLoader(fullname, f"{stem}.py")
            return spec_from_file_location(fullname, f"{stem}.py", loader=loader)
        if not self._stamps:
            self._stamps = compiled.stamps()
        library = f"{stem}{SUFFIX}"
        if self._stamps.get(library) != os.stat(library).st_mtime_ns:
            raise ImportError(
                f"'{library}' was built anew while this process was running. Its "
                "objects may have another layout than those that are loaded. Start the "
                "process again."
            )
        extension = ExtensionFileLoader(fullname, library)
        return spec_from_file_location(fullname, library, loader=extension)
