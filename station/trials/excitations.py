"""Compute the motions of a script over time."""

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from station.wire.excitations import (
    Chirp,
    Motion,
    Multisine,
    Recorded,
    Relay,
    Sine,
    Step,
    Waypoints,
)

Array: TypeAlias = NDArray[np.float64]

_LONGEST_FADE = 0.5
"""Longest time in which a sine fades in or out [s]."""


def offsets(motion: Motion, times: Array, duration: float) -> Array:
    """Return the offsets of a motion.

    Args:
        motion: The motion. A relay depends on the measured joint, so its offsets are 0
            here.
        times: Time since the beginning of the script [s], shape (k,).
        duration: Length of the script [s], > 0.

    Returns:
        Offsets [unit of the set-point], shape (k,).
    """
    match motion:
        case Step():
            return np.where(times >= motion.at, motion.amplitude, 0.0)
        case Waypoints():
            return _waypoints(motion.times, motion.values, times)
        case Recorded(between="smooth"):
            return _through(motion.times, motion.values, times)
        case Recorded():
            index = np.searchsorted(np.array(motion.times), times, side="right")
            return np.array((0.0, *motion.values))[index]
        case Relay():
            return np.zeros_like(times)
        case Sine() | Chirp() | Multisine():
            length = duration - motion.at if motion.lasts is None else motion.lasts
            t = times - motion.at
            return _envelope(t, length) * motion.amplitude * _wave(motion, length)(t)


def _wave(motion: Sine | Chirp | Multisine, length: float) -> Callable[[Array], Array]:
    """Return the wave, -1 to 1, as a function of the time since it began."""
    if isinstance(motion, Sine):
        rate = 2.0 * math.pi * motion.frequency
        return lambda t: np.sin(rate * t)
    if isinstance(motion, Chirp):
        growth = (motion.last - motion.first) / length if length > 0.0 else 0.0
        first = motion.first
        return lambda t: np.sin(2.0 * math.pi * (first * t + 0.5 * growth * t * t))
    frequencies = motion.frequencies
    phases = schroeder_phases(len(frequencies))
    return lambda t: sum(
        (
            np.sin(2.0 * math.pi * f * t + phase) / len(frequencies)
            for f, phase in zip(frequencies, phases, strict=True)
        ),
        np.zeros_like(t),
    )


def schroeder_phases(count: int) -> Sequence[float]:
    """Return Schroeder's phases of equally strong sines [rad], shape (count,)."""
    return [-math.pi * k * (k - 1) / count for k in range(1, count + 1)]


def fade_of(length: float) -> float:
    """Return the time in which a sine of a given length fades in or out [s], > 0."""
    # A fade takes a quarter of the length at most, so that half of a short signal has
    # its full amplitude.
    return max(min(_LONGEST_FADE, 0.25 * length), 1e-9)


def _envelope(t: Array, length: float) -> Array:
    """Return weights from 0 to 1 that begin and end at 0 smoothly, shape (k,)."""
    inside = np.clip(np.minimum(t, length - t) / fade_of(length), 0.0, 1.0)
    return least_jerk(inside)


def least_jerk(share: Array) -> Array:
    """Return the share of a least-jerk motion that is done at a share of its time."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


def _waypoints(times: Sequence[float], values: Sequence[float], at: Array) -> Array:
    found = np.zeros_like(at)
    begin, value = 0.0, 0.0
    for end, target in zip(times, values, strict=True):
        share = np.clip((at - begin) / (end - begin), 0.0, 1.0)
        found += (target - value) * least_jerk(share)
        begin, value = end, target
    return found


def _through(times: Sequence[float], values: Sequence[float], at: Array) -> Array:
    """Return a curve through values, with continuous rates; 0 before the first value.

    It consists of cubic Hermite pieces, whose slopes at the values are central
    differences.
    """
    knots, heights = np.array(times), np.array(values)
    if len(knots) == 1:
        return np.where(at >= knots[0], heights[0], 0.0)
    # With the same slope on both sides, the velocity does not jump at a knot.
    slopes = np.gradient(heights, knots)
    left = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
    width = knots[left + 1] - knots[left]
    share = np.clip((at - knots[left]) / width, 0.0, 1.0)
    rest = 1.0 - share
    found: Array = (
        heights[left] * (1.0 + 2.0 * share) * rest**2
        + heights[left + 1] * (1.0 + 2.0 * rest) * share**2
        + width * share * rest * (slopes[left] * rest - slopes[left + 1] * share)
    )
    return np.where(at >= knots[0], found, 0.0)
