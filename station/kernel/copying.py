"""Copy doubles from one place to another."""

import cython

from station.kernel.doubles import Doubles


def copy_into(target: Doubles, start: int, source: Doubles, size: int) -> None:
    """Copy numbers.

    Compiled, a loop takes a tenth of the time of an assignment to a slice, and
    interpreted the other way round.

    Args:
        target: Where to, shape (>= start + size,).
        start: Index of the first number in `target`.
        source: The numbers, shape (size,).
        size: How many there are.
    """
    if cython.compiled:
        for i in range(size):
            target[start + i] = source[i]
    else:
        target[start : start + size] = source
