"""Operations on many doubles at once.

Compiled, these are loops in C, which take a tenth of the time of Python's operations on
memory. Interpreted, Python's operations on memory are ten times faster than loops.
"""

from math import hypot
from operator import mul
from typing import Any

import cython

from station.memory.doubles import Doubles, Storage

if cython.compiled:
    from cython.cimports.libc.string import memmove


def copy_into(
    target: Storage,
    start: int,
    source: Any,  # noqa: ANN401 - a `Storage`; for a view it must be a view
    size: int,
) -> None:
    """Copy numbers into a part of a vector.

    Args:
        target: Receives the numbers, shape (>= start + size,).
        start: Index of the first number in `target`.
        source: The numbers, shape (size,); a view if the target is one.
        size: Number of elements to copy.
    """
    if cython.compiled:
        memmove(cython.address(target[start]), cython.address(source[0]), 8 * size)
    else:
        target[start : start + size] = source


def differ(first: Doubles, second: Doubles, size: int) -> bool:
    """Return whether two vectors differ in any number.

    Args:
        first: One vector, shape (size,).
        second: The other vector, shape (size,).
        size: Number of elements to compare.
    """
    if cython.compiled:
        for i in range(size):
            if first[i] != second[i]:
                return True
        return False
    return first != second


def are_finite(numbers: Storage, size: int) -> bool:
    """Return whether all numbers are known to be finite; False if their sum overflows.

    Args:
        numbers: The numbers, shape (size,).
        size: Number of elements to check.
    """
    total = 0.0
    if cython.compiled:
        for i in range(size):
            total += numbers[i]
    else:
        total = sum(numbers)
    # The difference is NaN for an infinite sum, and NaN is not equal to 0.
    return total - total == 0.0


def any_of(numbers: Doubles, size: int) -> bool:
    """Return whether any number is not 0.

    Args:
        numbers: The numbers, shape (size,).
        size: Number of elements to check.
    """
    if cython.compiled:
        for i in range(size):
            if numbers[i] != 0.0:
                return True
        return False
    return any(numbers)


def are_within(numbers: Doubles, shares: Doubles, size: int) -> bool:
    """Return whether every number is known to be within its limit; False for NaN.

    The test is that the sum of (number / limit)^2 is at most 1, which is stricter than
    the limits: False does not mean that a limit is exceeded.

    Args:
        numbers: The numbers, shape (size,).
        shares: Inverse of the limit of each number, shape (size,).
        size: Number of elements to check.
    """
    if cython.compiled:
        total = 0.0
        for i in range(size):
            relative = numbers[i] * shares[i]
            total += relative * relative
        return total <= 1.0
    return hypot(*map(mul, numbers, shares)) <= 1.0


class FiniteCheck:
    """Finds a number that is not finite.

    Args:
        memory: The numbers, shape (n,).
    """

    def __init__(self, memory: Doubles) -> None:
        self.memory = memory
        self.size = len(memory)

    def first_bad(self) -> int:
        """Return the index of the first number that is not finite; -1 for none."""
        memory, size = self.memory, self.size
        if are_finite(memory, size):
            return -1  # all are finite
        for i in range(size):
            value = memory[i]
            if value - value != 0.0:
                return i
        return -1
