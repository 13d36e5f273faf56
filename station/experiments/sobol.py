"""Sobol's sequence: points that fill a cube more evenly than chance.

Source:
    S. Joe and F. Y. Kuo, Constructing Sobol sequences with better two-dimensional
    projections, SIAM J. Sci. Comput. 30, 2008: the direction numbers, which are those
    of their file new-joe-kuo-6. I. A. Antonov and V. M. Saleev, 1979: the order by
    Gray code.
"""

import numpy as np

from station.trials.errors import ImpossibleRangeError

_BITS = 32
_SCALE = 2.0**-_BITS
_DIRECTIONS: tuple[tuple[int, tuple[int, ...]], ...] = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
    (2, (1, 1, 5, 5, 17)),
    (4, (1, 1, 5, 5, 5)),
    (7, (1, 1, 7, 11, 19)),
    (11, (1, 1, 5, 1, 1)),
    (13, (1, 1, 1, 3, 11)),
    (14, (1, 3, 5, 5, 31)),
    (1, (1, 3, 3, 9, 7, 49)),
    (13, (1, 1, 1, 15, 21, 21)),
    (16, (1, 3, 1, 13, 27, 49)),
    (19, (1, 1, 1, 15, 7, 5)),
    (22, (1, 3, 1, 15, 13, 25)),
    (25, (1, 1, 5, 5, 19, 61)),
    (1, (1, 3, 7, 11, 23, 15, 103)),
    (4, (1, 3, 7, 13, 13, 15, 69)),
)
"""Inner coefficients of the primitive polynomial and first direction numbers, from the
second dimension on."""
WIDEST = len(_DIRECTIONS) + 1
"""Most dimensions."""


def sobol(count: int, width: int, seed: int = 0) -> list[list[float]]:
    """Return points of the unit cube, shape (count, width).

    The points are shifted by a random bit pattern per dimension, which keeps how evenly
    they are spread. Powers of two are the best counts.

    Args:
        count: How many points, >= 0 and < 2**32.
        width: Number of dimensions, 1 to 21.
        seed: Seed of the shift, >= 0.

    Raises:
        ImpossibleRangeError: There are too many dimensions.
    """
    if width > WIDEST:
        raise ImpossibleRangeError(
            f"Sobol's sequence has {width} parameters here; allowed are 1 to {WIDEST}.",
            remedy="Choose the method random or halton.",
        )
    directions = [_directions(dimension) for dimension in range(width)]
    shifts = np.random.default_rng(seed).integers(0, 2**_BITS, width, dtype=np.uint64)
    state = [int(shift) for shift in shifts]
    found = []
    for number in range(count):
        found.append([value * _SCALE for value in state])
        # The lowest bit of the number that is 0 is the one that Gray code changes.
        bit = (~number & (number + 1)).bit_length() - 1
        state = [
            value ^ column[bit] for value, column in zip(state, directions, strict=True)
        ]
    return found


def _directions(dimension: int) -> list[int]:
    """Return the direction numbers of a dimension, shape (32,)."""
    if dimension == 0:
        return [1 << (_BITS - 1 - i) for i in range(_BITS)]
    coefficients, first = _DIRECTIONS[dimension - 1]
    degree = len(first)
    found = [m << (_BITS - 1 - i) for i, m in enumerate(first)]
    for i in range(degree, _BITS):
        value = found[i - degree] ^ (found[i - degree] >> degree)
        for k in range(1, degree):
            if coefficients >> (degree - 1 - k) & 1:
                value ^= found[i - k]
        found.append(value)
    return found
