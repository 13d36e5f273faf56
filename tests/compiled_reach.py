"""Which tests run a second time, interpreted: those that name a compiled module."""

import sys
from functools import cache
from types import ModuleType

from station.compiled import compiled_modules

_COMPILED = frozenset(compiled_modules())
_WHOLE_CYCLES = "tests.conformance."


@cache
def reaches_compiled(name: str) -> bool:
    """Return whether a module of tests names a compiled module, or has a part of one.

    The suites of `tests/conformance` count too. They name no compiled module, but run
    whole cycles.

    Args:
        name: The module's name; it is imported.
    """
    return name.startswith(_WHOLE_CYCLES) or any(
        (value.__name__ if isinstance(value, ModuleType) else _origin(value))
        in _COMPILED
        for value in vars(sys.modules[name]).values()
    )


def _origin(value: object) -> str | None:
    return getattr(value, "__module__", None)
