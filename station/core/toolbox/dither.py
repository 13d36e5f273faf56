"""Add white noise to a command, to shake a joint or to overcome its stiction.

The polar method turns two uniform random numbers into two independent Gaussian ones;
the second one is kept for the next call.

Source: control_toolbox@de05a5c src/dither.cpp, Dither; the sequence is that of C++'s
`std::mt19937` with libstdc++'s `std::uniform_real_distribution`.
"""

from math import isfinite, log, sqrt
from random import Random

from station.core.errors import InvalidGainError

_TRIES = 100
_STATE_SIZE = 624
_WORD = 1 << 32


class Dither:
    """Return Gaussian noise of a given standard deviation."""

    def __init__(self, amplitude: float, seed: int) -> None:
        """Seed the generator.

        Args:
            amplitude: Standard deviation, >= 0, in the unit of the command.
            seed: From 0 to 2^32 - 1; the same seed gives the same sequence.

        Raises:
            InvalidGainError: The amplitude is negative or not finite, or the seed is
                out of its range.
        """
        if not (isfinite(amplitude) and amplitude >= 0.0):
            raise InvalidGainError(
                f"Dither amplitude is {amplitude}; allowed are finite numbers >= 0.",
                remedy="Give the standard deviation of the noise.",
            )
        if not 0 <= seed < _WORD:
            raise InvalidGainError(
                f"Dither seed is {seed}; allowed is 0 to {_WORD - 1}.",
                remedy="Give an integer in this range.",
            )
        self._amplitude: float = amplitude
        self._random: Random = _seeded_generator(seed)
        self._saved: float | None = None

    def update(self) -> float:
        """Return the next value of the noise."""
        if self._saved is not None:
            saved = self._saved
            self._saved = None
            return saved
        first = second = 0.0
        square = 1.0
        for _ in range(_TRIES):
            first = self._uniform()
            second = self._uniform()
            square = first * first + second * second
            if 0.0 < square <= 1.0:
                break
        square = min(square, 1.0) or 1.0
        factor = self._amplitude * sqrt(-2.0 * log(square) / square)
        self._saved = factor * second
        return factor * first

    def _uniform(self) -> float:
        # Two words of 32 bits make a number from 0 to 1; the first word is the lower.
        low = float(self._random.getrandbits(32))
        high = float(self._random.getrandbits(32))
        fraction = (low + high * float(_WORD)) / (float(_WORD) * float(_WORD))
        return fraction * 2.0 - 1.0


def _seeded_generator(seed: int) -> Random:
    # Python seeds the same generator differently from C++.
    words = [seed]
    for index in range(1, _STATE_SIZE):
        last = words[-1] ^ (words[-1] >> 30)
        words.append((1812433253 * last + index) % _WORD)
    generator = Random()
    generator.setstate((3, (*words, _STATE_SIZE), None))
    return generator
