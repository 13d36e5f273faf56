"""Doubles in contiguous memory, which Python, NumPy, MuJoCo and compiled code share.

A view is indexed and iterated like a list of floats, `.tolist()` copies it, and a slice
of it is another view. Its length is fixed, and all its elements are doubles.
"""

from array import array
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from station.compiled import status

if TYPE_CHECKING:
    Doubles: TypeAlias = memoryview[float]
    Storage: TypeAlias = list[float] | memoryview[float]
    Indices: TypeAlias = memoryview[int]
else:
    # In Python 3.11 this type has no parameters at run time.
    Doubles: TypeAlias = memoryview
    Storage: TypeAlias = list | memoryview
    Indices: TypeAlias = memoryview


def doubles(values: Iterable[float]) -> Doubles:
    """Return new memory with these values, shape (n,)."""
    return memoryview(bytearray(array("d", values).tobytes())).cast("d")


def zeros(size: int) -> Doubles:
    """Return new memory with `size` zeros."""
    return memoryview(bytearray(8 * size)).cast("d")


def given_or_zeros(memory: Doubles | None, size: int) -> Doubles:
    """Return `memory`, or new memory with `size` zeros if it is None."""
    return zeros(size) if memory is None else memory


def as_doubles(values: Any) -> Doubles:  # noqa: ANN401 - whatever has such memory
    """Return the memory of an array of doubles, e.g. a NumPy array."""
    return memoryview(values)


def viewed(values: Sequence[float]) -> Doubles:
    """Return memory with these values; a view is returned itself."""
    return values if isinstance(values, memoryview) else doubles(values)


def own(values: Iterable[float]) -> Any:  # noqa: ANN401 - a `Storage` of two kinds
    """Return memory with these values for one compiled object only; see `own_zeros`."""
    return doubles(values) if status().is_compiled else [*values]


def own_zeros(size: int) -> Storage:
    """Return memory with `size` zeros for one compiled object only.

    In interpreted mode it is a list, whose elements Python reads in half the time.
    """
    return zeros(size) if status().is_compiled else [0.0] * size


def own_block(parts: Sequence[str], size: int) -> dict[str, Storage]:
    """Return memory for one compiled object only: named parts of `size` zeros each.

    The parts lie side by side; in interpreted mode they are lists, see `own_zeros`.
    """
    if status().is_compiled:
        block = Block(dict.fromkeys(parts, size))
        return {part: block[part] for part in parts}
    return {part: [0.0] * size for part in parts}


def indices(values: Iterable[int]) -> Indices:
    """Return new memory with whole numbers, e.g. indices, shape (n,)."""
    return memoryview(array("l", values))


def put(view: Storage, values: Iterable[float]) -> None:
    """Copy values into a view, or into memory for one compiled object only.

    Args:
        view: Receives the values, shape (n,).
        values: Numbers, shape (n,).

    Raises:
        TypeError: A value is not a number.
        ValueError: There are more or fewer than n values; nothing was copied.
    """
    numbers = values if isinstance(values, memoryview) else array("d", values)
    if len(numbers) != len(view):
        raise ValueError(f"{len(numbers)} values for {len(view)} places")
    view[:] = numbers


class Block:
    """One flat block of doubles with named parts.

    Args:
        sizes: Name of each part to its number of doubles.

    Attributes:
        memory: The whole block, shape (n,).
    """

    def __init__(self, sizes: dict[str, int]) -> None:
        self.memory = zeros(sum(sizes.values()))
        self._parts: dict[str, Doubles] = {}
        start = 0
        for name, size in sizes.items():
            self._parts[name] = self.memory[start : start + size]
            start += size

    def __getitem__(self, name: str) -> Doubles:
        """Return the view of a part; always the same object."""
        return self._parts[name]
