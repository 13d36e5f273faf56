"""Which tests reach compiled modules: these run twice, compiled and interpreted."""

import sys
from functools import cache
from types import ModuleType

from station.compiled import compiled_modules

_COMPILED = frozenset(compiled_modules())
# What helps tests is followed to what it helps with.
_HELPERS = ("tests.", "station.testing.")
_WHOLE_CYCLES = "tests.conformance."


@cache
def reaches_compiled(name: str) -> bool:
    """Return whether a module of tests reaches a compiled module.

    It does if it, its conftest or a helper that it uses names a part of a compiled
    module. The suites of `tests/conformance` name none, and do: they are whole cycles.

    Args:
        name: The module's name; it is imported.
    """
    if name.startswith(_WHOLE_CYCLES):
        return True
    folders = name.split(".")[:-1]
    conftests = [
        ".".join([*folders[:depth], "conftest"])
        for depth in range(2, len(folders) + 1)  # that of all tests says nothing
    ]
    return any(_reaches(one, set()) for one in (name, *conftests) if one in sys.modules)


def _reaches(name: str, seen: set[str]) -> bool:
    seen.add(name)
    for used in _used_by(name) - seen:
        if used in _COMPILED:
            return True
        if used.startswith(_HELPERS) and _reaches(used, seen):
            return True
    return False


@cache
def _used_by(name: str) -> frozenset[str]:
    """Return the modules that a module names, or that it has something of."""
    if name not in sys.modules or not name.startswith(("tests.", "station.")):
        return frozenset()
    values = vars(sys.modules[name]).values()
    return frozenset(
        value.__name__ if isinstance(value, ModuleType) else str(owner)
        for value in values
        if isinstance(value, ModuleType)
        or (owner := getattr(value, "__module__", None)) is not None
    )
