"""Choose the values for the trials of a sweep: ranges, and points within them."""

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from station.trials.errors import ImpossibleRangeError
from station.trials.parameters import check, is_whole

Method = Literal["grid", "random", "halton", "sobol"]
METHODS: Sequence[Method] = ("grid", "random", "halton", "sobol")
_BITS = 32
"""Bits of Sobol's points, and of their shift."""
_INTERVAL = re.compile(r"([^:,]+):([^:,]+)(?::(\d+))?")
_MOST = 1_000_000
"""Most trials of one experiment: a larger number is probably a typing error."""


@dataclass(frozen=True, slots=True)
class Range:
    """The values of one parameter: an interval, or single values.

    Args:
        name: The parameter.
        low: Lowest value.
        high: Highest value, >= `low`.
        count: Number of points of a grid in the interval, >= 1; only a grid needs it.
        values: Single values instead of the interval.

    Raises:
        UnknownParameterError: The parameter is unknown.
        ImpossibleRangeError: The range is empty or beyond the allowed one.
    """

    name: str
    low: float
    high: float
    count: int | None = None
    values: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for value in (self.low, self.high, *self.values):
            if not math.isfinite(value):
                raise ImpossibleRangeError(
                    f"The range of '{self.name}' has {value}; allowed are finite "
                    "numbers."
                )
            check(self.name, value)
        if self.low > self.high or (self.count is not None and self.count < 1):
            raise ImpossibleRangeError(
                f"The range of '{self.name}' is empty: {self.low:g} to {self.high:g}"
                f"{'' if self.count is None else f' in {self.count} points'}.",
                remedy="Give the lower end first, and at least one point.",
                details={"parameter": self.name},
            )

    def at(self, share: float) -> float:
        """Return the value at a share of the range, 0 to 1."""
        if self.values:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        if is_whole(self.name):
            whole = int(self.low) + int(share * (int(self.high) - int(self.low) + 1))
            return float(min(whole, int(self.high)))
        return self.low + share * (self.high - self.low)

    def grid(self) -> list[float]:
        """Return the values of a grid.

        Raises:
            ImpossibleRangeError: The range is an interval without a count.
        """
        if self.values:
            return list(self.values)
        if self.count is None:
            raise ImpossibleRangeError(
                f"A grid needs to know how many values '{self.name}' has.",
                remedy=f"Write {self.name}={self.low:g}:{self.high:g}:5, or values "
                "with commas, or choose another method.",
            )
        found: list[float] = np.linspace(self.low, self.high, self.count).tolist()
        for value in found:
            check(self.name, value)
        return found


def parse_range(text: str) -> Range:
    """Return the range of `NAME=LOW:HIGH`, `NAME=LOW:HIGH:COUNT` or `NAME=A,B,C`.

    Raises:
        UnknownParameterError: The parameter is unknown.
        ImpossibleRangeError: The text is malformed, or the range is impossible.
    """
    name, _, rest = text.partition("=")
    match = _INTERVAL.fullmatch(rest)
    if match:
        low, high, count = match.groups()
        points_in_grid = None if count is None else int(count)
        return Range(name, _number(low, text), _number(high, text), points_in_grid)
    values = tuple(_number(part, text) for part in rest.split(","))
    return Range(name, min(values), max(values), None, values)


def _number(part: str, text: str) -> float:
    """Return a number of a range.

    Raises:
        ImpossibleRangeError: The text is malformed.
    """
    try:
        return float(part)
    except ValueError as error:
        raise ImpossibleRangeError(
            f"{text!r} is no range.",
            remedy="Write NAME=LOW:HIGH, NAME=LOW:HIGH:COUNT or NAME=A,B,C, such as "
            "load=0:3.",
        ) from error


def points(
    ranges: Sequence[Range], method: Method, count: int, seed: int = 0
) -> list[Mapping[str, float]]:
    """Return the parameters of each trial.

    Args:
        ranges: The ranges, of different parameters.
        method: `grid` makes every combination. The others make `count` points: `random`
            independent ones, `halton` and `sobol` evenly spread ones.
        count: Number of points, >= 1; a grid ignores it.
        seed: Seed of `random`, and of the shuffles of the evenly spread ones, >= 0.

    Raises:
        ImpossibleRangeError: Two ranges have the same parameter, there are no ranges,
            or there are more than a million trials.
    """
    names = [one.name for one in ranges]
    if not names or len(set(names)) < len(names):
        raise ImpossibleRangeError(
            f"The ranges are of {', '.join(names) or 'no parameter'}; each parameter "
            "may have one, and there must be one at least."
        )
    if method == "grid":
        grids = [one.grid() for one in ranges]
        _check_count(math.prod(map(len, grids)))
        return [
            dict(zip(names, combination, strict=True))
            for combination in itertools.product(*grids)
        ]
    _check_count(count)
    shares = _shares(method, count, len(names), seed)
    return [
        {one.name: one.at(share) for one, share in zip(ranges, row, strict=True)}
        for row in shares
    ]


def _check_count(count: int) -> None:
    """Refuse a number of trials of 0, or above the limit.

    Raises:
        ImpossibleRangeError: There are no trials, or too many.
    """
    if not 1 <= count <= _MOST:
        raise ImpossibleRangeError(
            f"The experiment would have {count} trials; allowed are 1 to {_MOST}."
        )


def sobol(count: int, width: int, seed: int = 0) -> list[list[float]]:
    """Return points of the unit cube, shape (count, width).

    Each dimension is shifted by a random bit pattern, which keeps the points evenly
    spread. Powers of two are the best counts.

    Args:
        count: How many points, >= 1 and < 2**32.
        width: Number of dimensions, >= 1.
        seed: Seed of the shift, >= 0.
    """
    # Imported here, because other sweeps need no SciPy, which comes with an extra.
    from scipy.stats import qmc

    sequence = qmc.Sobol(width, scramble=False, bits=_BITS)
    # Make a power of two of points, because SciPy warns of other counts.
    even = sequence.random_base2((count - 1).bit_length())[:count]
    shifts = np.random.default_rng(seed).integers(0, 2**_BITS, width, dtype=np.uint64)
    shifted: list[list[float]] = (
        ((even * 2.0**_BITS).astype(np.uint64) ^ shifts) * 2.0**-_BITS
    ).tolist()
    return shifted


def _shares(method: Method, count: int, width: int, seed: int) -> list[list[float]]:
    """Return points of the unit cube, shape (count, width)."""
    if method == "sobol":
        return sobol(count, width, seed)
    random = np.random.default_rng(seed)
    if method == "random":
        drawn: list[list[float]] = random.random((count, width)).tolist()
        return drawn
    shift = random.random(width).tolist()
    columns = [
        [(_radical_inverse(i + 1, base) + offset) % 1.0 for i in range(count)]
        for base, offset in zip(_primes(width), shift, strict=True)
    ]
    return [list(row) for row in zip(*columns, strict=True)]


def _radical_inverse(number: int, base: int) -> float:
    """Return the reversed digits of a number as a fraction: Halton's sequence."""
    found, place = 0.0, 1.0 / base
    while number:
        number, digit = divmod(number, base)
        found += digit * place
        place /= base
    return found


def _primes(count: int) -> list[int]:
    found: list[int] = []
    candidate = 2
    while len(found) < count:
        if all(candidate % prime for prime in found):
            found.append(candidate)
        candidate += 1
    return found
