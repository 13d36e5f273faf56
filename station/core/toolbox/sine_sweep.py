"""Excite a joint with a sine whose frequency rises, to measure its response.

With the angular frequencies w1 and w2, the duration T and the amplitude A:

    command(t) = A * sin(K * (exp(t / L) - 1)),  K = w1 * T / ln(w2 / w1),
    L = T / ln(w2 / w1),  and 0 after T.

Source: control_toolbox@de05a5c src/sine_sweep.cpp, SineSweep.
"""

from math import exp, isfinite, log, pi, sin

from station.core.errors import InvalidGainError


class SineSweep:
    """Return the sweep's value at a time since its start."""

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
