"""Signals for a joint: noise against stiction, and a sweep to measure its response."""

from math import exp, isfinite, log, pi, sin, sqrt
from random import Random

from station.core.errors import InvalidGainError

_TRIES = 100
_STATE_SIZE = 624
_WORD = 1 << 32


class Dither:
    """Return Gaussian noise with a given standard deviation, against stiction.

    The polar method turns two uniform random numbers into two independent Gaussian
    ones; the second one is kept for the next call.

    Source:
        control_toolbox@de05a5c src/dither.cpp, Dither; the sequence is that of C++'s
        `std::mt19937` with libstdc++'s `std::uniform_real_distribution`.
    """

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
        # Two words of 32 bits make a number from 0 to 1; the first is the lower word.
        low = float(self._random.getrandbits(32))
        high = float(self._random.getrandbits(32))
        fraction = (low + high * float(_WORD)) / (float(_WORD) * float(_WORD))
        return fraction * 2.0 - 1.0


def _seeded_generator(seed: int) -> Random:
    # Seeded as in C++, because Python seeds the same generator differently.
    words = [seed]
    for index in range(1, _STATE_SIZE):
        last = words[-1] ^ (words[-1] >> 30)
        words.append((1812433253 * last + index) % _WORD)
    generator = Random()
    generator.setstate((3, (*words, _STATE_SIZE), None))
    return generator


class SineSweep:
    """Excite a joint with a sine whose frequency rises.

    With the angular frequencies w1 and w2, the duration T and the amplitude A:

        command(t) = A * sin(K * (exp(t / L) - 1)),  K = w1 * T / ln(w2 / w1),
        L = T / ln(w2 / w1),  and 0 after T.

    Source:
        control_toolbox@de05a5c src/sine_sweep.cpp, SineSweep.
    """

    def __init__(
        self,
        start_frequency: float,
        end_frequency: float,
        duration: float,
        amplitude: float,
    ) -> None:
        """Compute the constants of the sweep.

        Args:
            start_frequency: First frequency, > 0 [Hz].
            end_frequency: Last frequency, > `start_frequency` [Hz].
            duration: Length of the sweep, > 0 [s].
            amplitude: Largest value, >= 0, in the unit of the command.

        Raises:
            InvalidGainError: A value is out of its range or not finite.

        Source:
            control_toolbox@de05a5c SineSweep::init; differs: a start at 0 Hz, equal
            frequencies and a duration of 0, which make it divide by 0, are refused.
        """
        numbers = (start_frequency, end_frequency, duration, amplitude)
        is_valid = 0.0 < start_frequency < end_frequency and duration > 0.0
        if not (is_valid and amplitude >= 0.0 and all(map(isfinite, numbers))):
            raise InvalidGainError(
                f"A sine sweep from {start_frequency} to {end_frequency} Hz in "
                f"{duration} s with amplitude {amplitude} is not possible.",
                remedy="Give 0 < start < end [Hz], a duration > 0, an amplitude >= 0.",
            )
        self._amplitude: float = amplitude
        self._duration: float = duration
        start = 2.0 * pi * start_frequency
        ratio = log(2.0 * pi * end_frequency / start)
        self._k: float = start * duration / ratio
        self._l: float = duration / ratio

    def update(self, time: float) -> float:
        """Return the command at a time.

        Args:
            time: Time since the start of the sweep [s], >= 0.

        Returns:
            The command; 0 after the end of the sweep.
        """
        if time > self._duration:
            return 0.0
        return self._amplitude * sin(self._k * (exp(time / self._l) - 1.0))
