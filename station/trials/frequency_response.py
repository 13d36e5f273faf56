"""Frequency responses from records of an excited joint, and figures from them.

The module uses only NumPy, so that a station without the extra `experiments` can
measure responses, too.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.trials.excitations import Array

Spectrum = NDArray[np.complex128]

_WIDTH = 0.06
"""Half-width of the band over which spectra are averaged, as a share of the frequency.
The response of a joint is nearly straight within it, and at 10 Hz it averages the noise
of ten bins."""
_AT_REST = 0.02
"""Share of a signal's range within which both its ends count as rest."""
_PER_DECADE = 40
"""Frequencies per decade of a response over a band."""
_CERTAIN = 0.6
"""Coherence below which a frequency is not used for margins."""
_UNEXPLAINED = 0.4
"""Largest share of a plant's response that a model of inertia and damping may leave
unexplained."""
_LONGEST_DELAY = 0.05
"""Longest delay of a plant that the fit tries [s]."""
_HALF_POWER = math.sqrt(0.5)


@dataclass(frozen=True, slots=True)
class Curve:
    """A response over the frequency.

    Attributes:
        gain: Gains, shape (k,).
        phase: Phases without jumps [deg], shape (k,), their median within -270 to 90.
    """

    gain: Array
    phase: Array


@dataclass(frozen=True, slots=True)
class JointResponse:
    """The three responses of a joint in its loop.

    Attributes:
        frequency: Frequencies, increasing [Hz], shape (k,).
        coherence: Share of the position's power that the set-point explains, 0 to 1,
            shape (k,).
        closed_loop: From set-point to position.
        open_loop: From the error to the position.
        plant: From the controller's command to the position [rad per its unit].
    """

    frequency: Array
    coherence: Array
    closed_loop: Curve
    open_loop: Curve
    plant: Curve


def joint_response(
    signals: Mapping[str, Array], period: float, frequencies: Sequence[float] | Array
) -> JointResponse | None:
    """Return the responses of a joint from its set-point, position and command.

    All three are quotients of cross-spectra with the set-point. The noise of the loop
    is not correlated with the set-point, so the feedback does not bias them. The
    spectra are averaged over neighbouring frequencies. A record that begins and ends at
    rest has no leakage, and is used as it is; any other record is tapered.

    Args:
        signals: `desired`, `position` and `output` in each cycle, shape (n,) each.
        period: Time between two samples [s], > 0.
        frequencies: Frequencies that were excited [Hz], increasing.

    Returns:
        The responses at the frequencies that the record can resolve; None if it can
        resolve none.

    Source:
        L. Ljung, System Identification, 2nd ed., 1999, sections 6.4 and 13.5: smoothed
        spectra, and the indirect and joint input-output methods for closed loops.
    """
    count = len(signals["desired"])
    if count < 16:
        return None
    names = ("desired", "position", "output")
    reference, position, output = (
        _spectrum(signals[name], is_tapered=not _is_at_rest(signals)) for name in names
    )
    bins = np.fft.rfftfreq(count, period)
    rows: list[tuple[float, ...]] = []
    found: list[tuple[complex, complex, complex]] = []
    for frequency in np.asarray(frequencies, np.float64).tolist():
        half = max(_WIDTH * frequency, 1.01 * bins[1])
        near = slice(*np.searchsorted(bins, (frequency - half, frequency + half)))
        near = slice(max(near.start, 1), near.stop)  # without the mean
        r, y, u = reference[near], position[near], output[near]
        s_rr, s_yy = _power(r), _power(y)
        if not len(r) or s_rr == 0.0 or s_yy == 0.0:
            continue
        s_ry, s_ru = complex(np.vdot(r, y)), complex(np.vdot(r, u))
        s_re = s_rr - s_ry
        if s_ru == 0.0 or s_re == 0.0:
            continue
        # Use the centre of the power, not of the band, so that a single line keeps its
        # frequency.
        centre = float((bins[near] * np.abs(r) ** 2).sum() / s_rr)
        rows.append((centre, abs(s_ry) ** 2 / (s_rr * s_yy)))
        found.append((s_ry / s_rr, s_ry / s_re, s_ry / s_ru))
    if not rows:
        return None
    frequency, coherence = (np.array(column) for column in zip(*rows, strict=True))
    curves = [_curve(np.array(column)) for column in zip(*found, strict=True)]
    return JointResponse(frequency, coherence, *curves)


def frequencies_between(low: float, high: float) -> Array:
    """Return frequencies between two bounds, evenly spaced in the logarithm [Hz].

    Args:
        low: The first, > 0 [Hz].
        high: The last, > `low` [Hz].
    """
    count = max(2, math.ceil(_PER_DECADE * math.log10(high / low)) + 1)
    return np.geomspace(low, high, count)


def figures_of(response: JointResponse) -> dict[str, float]:
    """Return bandwidth, peak, margins and crossovers, if they lie in the measured band.

    Margins are those of the open loop: the gain margin is the factor on all gains at
    which the loop begins to oscillate, at the phase crossover.
    """
    frequency = response.frequency
    is_certain = response.coherence >= _CERTAIN
    loop, closed = response.open_loop, response.closed_loop
    found: dict[str, float] = {"coherence": float(np.median(response.coherence))}
    # At low frequencies only a few bins are averaged, and they may agree by chance.
    if len(frequency) < 3 or found["coherence"] < _CERTAIN:
        return found
    found["resonance_peak"] = float(closed.gain[is_certain].max(initial=0.0))
    at = _crossing(frequency, closed.gain, _HALF_POWER, is_certain)
    if at is not None:
        found["bandwidth"] = at
    at = _crossing(frequency, loop.gain, 1.0, is_certain)
    if at is not None:
        found["gain_crossover"] = at
        # Noise at a low frequency may have added whole turns, which do not count.
        found["phase_margin"] = _at(frequency, loop.phase, at) % 360.0 - 180.0
    lag = np.sin(np.radians(loop.phase))
    is_behind = np.cos(np.radians(loop.phase)) < 0.0
    at = _crossing(frequency, -lag, 0.0, is_certain & is_behind)
    if at is not None:
        found["phase_crossover"] = at
        found["gain_margin"] = 1.0 / _at(frequency, loop.gain, at)
    return found


def mass_and_damping(response: JointResponse) -> dict[str, float]:
    """Return inertia, damping and delay of the plant, if such a model fits.

    It fits `1 / plant = (damping * s + inertia * s**2) * exp(delay * s)` by least
    squares, with the same weight for each frequency. It returns nothing if the model
    leaves more than `_UNEXPLAINED` of the plant unexplained, or a value would be
    negative.
    """
    omega = 2.0 * math.pi * response.frequency
    phase = np.radians(response.plant.phase)
    best, found = _UNEXPLAINED**2, {}
    for delay in np.linspace(0.0, _LONGEST_DELAY, 51).tolist():
        ways = np.exp(-1j * (phase + omega * delay)) / response.plant.gain
        weight = 1.0 / np.abs(ways) ** 2
        inertia = -float((ways.real * omega**2 * weight).sum())
        inertia /= float((omega**4 * weight).sum())
        damping = float((ways.imag * omega * weight).sum())
        damping /= float((omega**2 * weight).sum())
        rest = ways + inertia * omega**2 - 1j * omega * damping
        left = float(np.mean(np.abs(rest) ** 2 * weight))
        if left < best and inertia > 0.0 and damping >= 0.0:
            best = left
            found = {"inertia": inertia, "damping": damping, "delay": delay}
    return found


def sine_figures(
    desired: Array, position: Array, period: float, frequency: float
) -> dict[str, float]:
    """Return gain and phase of a sine, by least squares over the last whole periods.

    Args:
        desired: Set-points, shape (n,).
        position: Positions, shape (n,).
        period: Time between two samples [s], > 0.
        frequency: Frequency of the sine [Hz].

    Returns:
        `gain` and `phase` [deg]; nothing when the record is shorter than a period.

    Source:
        IEEE Std 1057-2017, section 4: the three-parameter sine fit.
    """
    length = 1.0 / (frequency * period)
    samples = round(math.floor(len(desired) / length) * length)
    if samples < 4 or not desired.any():
        return {}
    angle = 2.0 * math.pi * frequency * period * np.arange(samples)
    base = np.column_stack((np.cos(angle), -np.sin(angle), np.ones(samples)))
    columns = np.column_stack((desired[-samples:], position[-samples:]))
    fitted = np.linalg.lstsq(base, columns, rcond=None)[0]
    wave = fitted[0] + 1j * fitted[1]
    if wave[0] == 0.0:
        return {}
    answer = wave[1] / wave[0]
    return {"gain": float(abs(answer)), "phase": float(np.degrees(np.angle(answer)))}


def _is_at_rest(signals: Mapping[str, Array]) -> bool:
    for name in ("desired", "position"):
        values = signals[name]
        if abs(values[-1] - values[0]) > _AT_REST * np.ptp(values):
            return False
        # A sine may end at its mean without being at rest, so check the rate at the
        # ends.
        rate = np.abs(np.diff(values))
        if max(rate[0], rate[-1]) > 0.1 * rate.max(initial=0.0):
            return False
    return True


def _spectrum(values: Array, *, is_tapered: bool) -> Spectrum:
    if not is_tapered:
        return np.fft.rfft(values - values[0])
    return np.fft.rfft((values - values.mean()) * np.hanning(len(values)))


def _power(spectrum: Spectrum) -> float:
    return float((np.abs(spectrum) ** 2).sum())


def _curve(answers: Spectrum) -> Curve:
    phase = np.degrees(np.unwrap(np.angle(answers)))
    # An integrator begins at -90 or -180 degrees, which noise may turn into +179.
    phase -= 360.0 * math.ceil((float(np.median(phase)) - 90.0) / 360.0)
    return Curve(np.abs(answers), phase)


def _crossing(
    frequency: Array, values: Array, level: float, is_certain: NDArray[np.bool_]
) -> float | None:
    """Return the first frequency at which a curve falls below a level."""
    above = values >= level
    falls = np.flatnonzero(above[:-1] & ~above[1:] & is_certain[:-1] & is_certain[1:])
    if not len(falls):
        return None
    i = int(falls[0])
    share = (values[i] - level) / (values[i] - values[i + 1])
    return float(frequency[i] * (frequency[i + 1] / frequency[i]) ** share)


def _at(frequency: Array, values: Array, at: float) -> float:
    """Return a curve's value at a frequency, by interpolation."""
    return float(np.interp(math.log(at), np.log(frequency), values))
