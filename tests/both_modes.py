"""A compiled module in both modes, and the comparison of their results."""

import importlib
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import pytest
from hypothesis import strategies as st

import station.compiled
from station.compiled import CompilationStatus, compiled_modules, status

needs_both = pytest.mark.skipif(
    not status().is_compiled, reason=f"only one mode runs: {status().reason}"
)
"""Skips a test where there are no extensions to compare with."""

_NAMES = {name.rpartition(".")[2]: name for name in compiled_modules()}

SPECIAL = (0.0, -0.0, 5e-324, -5e-324, 1e308, -1e308, float("inf"), float("nan"))
numbers = st.one_of(st.floats(-4.0, 4.0), st.floats(), st.sampled_from(SPECIAL))
"""Doubles of all kinds, most of them ordinary."""


def arrays(size: int) -> st.SearchStrategy[list[float]]:
    """Return lists of `size` doubles of all kinds, most of them ordinary."""
    ordinary = st.lists(st.floats(-3.0, 3.0), min_size=size, max_size=size)
    return st.one_of(ordinary, st.lists(numbers, min_size=size, max_size=size))


@cache
def interpreted(name: str):
    """Return a compiled module as Python runs it, whatever the process runs.

    Args:
        name: Last part of the module's name.
    """
    with _sources_alone():
        return importlib.import_module(_NAMES[name])


def compiled(name: str):
    """Return the module as the process runs it."""
    return importlib.import_module(_NAMES[name])


def sibling(module, name: str):
    """Return another compiled module in the same mode."""
    return interpreted(name) if module.__file__.endswith(".py") else compiled(name)


def bits(values) -> list[bytes]:
    """Return the bytes of doubles; the same bytes for every NaN, whose bits vary."""
    nan = float("nan")
    return [struct.pack("d", nan if value != value else value) for value in values]


def assert_same(name: str, scenario) -> None:
    """Assert that a scenario has the same results in both modes, bit for bit.

    Args:
        name: Name of the module.
        scenario: Takes the module, and returns the doubles to compare.
    """
    slow, fast = interpreted(name), compiled(name)
    assert slow is not fast
    assert bits(scenario(slow)) == bits(scenario(fast))


@contextmanager
def _sources_alone() -> Iterator[None]:
    """Import the sources of compiled modules; put back what was loaded before."""
    loaded = {name: sys.modules.pop(name) for name in _loaded()}
    decide = station.compiled.status
    station.compiled.status = lambda: CompilationStatus("interpreted", "a test")
    try:
        yield
    finally:
        station.compiled.status = decide
        for name in _loaded():
            del sys.modules[name]
        sys.modules.update(loaded)
        for name, module in loaded.items():
            package, _, last = name.rpartition(".")
            setattr(sys.modules[package], last, module)


def _loaded() -> list[str]:
    return [name for name in _NAMES.values() if name in sys.modules]


def both(name: str):
    """Return both forms of a module; skip the test if only the sources run."""
    if not status().is_compiled:
        pytest.skip(status().reason)
    return interpreted(name), compiled(name)
