"""One module of the kernel in both modes, and the comparison of their results."""

import importlib
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import pytest
from hypothesis import strategies as st

import station.kernel

needs_both = pytest.mark.skipif(
    not station.kernel.STATUS.is_compiled,
    reason=f"only one mode runs: {station.kernel.STATUS.reason}",
)
"""Skips a test where there is no compiled kernel to compare with."""

SPECIAL = (0.0, -0.0, 5e-324, -5e-324, 1e308, -1e308, float("inf"), float("nan"))
numbers = st.one_of(st.floats(-4.0, 4.0), st.floats(), st.sampled_from(SPECIAL))
"""Doubles of all kinds, most of them ordinary."""


def arrays(size: int) -> st.SearchStrategy[list[float]]:
    """Return lists of `size` doubles of all kinds, most of them ordinary."""
    ordinary = st.lists(st.floats(-3.0, 3.0), min_size=size, max_size=size)
    return st.one_of(ordinary, st.lists(numbers, min_size=size, max_size=size))


@cache
def interpreted(name: str):
    """Return the module of the kernel as Python runs it, whatever the process runs."""
    with _sources_alone():
        return importlib.import_module(f"station.kernel.{name}")


def compiled(name: str):
    """Return the module of the kernel as the process runs it."""
    return importlib.import_module(f"station.kernel.{name}")


def sibling(module, name: str):
    """Return another module of the kernel in the same mode."""
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
    package = station.kernel
    path, prefix = list(package.__path__), f"{package.__name__}."
    loaded = {name: m for name, m in sys.modules.items() if name.startswith(prefix)}
    for name in loaded:
        del sys.modules[name]
    package.__path__[:] = path[-1:]
    try:
        yield
    finally:
        package.__path__[:] = path
        for name in [each for each in sys.modules if each.startswith(prefix)]:
            del sys.modules[name]
        sys.modules.update(loaded)
        for name, module in loaded.items():
            setattr(package, name.removeprefix(prefix), module)


def both(name: str):
    """Return both forms of a module; skip the test if the kernel runs interpreted."""
    if not station.kernel.STATUS.is_compiled:
        pytest.skip(station.kernel.STATUS.reason)
    return interpreted(name), compiled(name)
