"""Figures of merit of a response that was measured on one joint."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SETTLING_BAND = 0.02
"""Half the width of the band a settled response stays in, as a part of the step."""
_TAIL = 0.1


@dataclass(frozen=True, slots=True)
class ResponseMetrics:
    """How a joint followed what it was told.

    Attributes:
        rise: Time from 10 % to 90 % of a step [s]; None when 90 % was not reached.
        overshoot: Largest excursion beyond a step's end, as a part of the step.
        settling: Time after which the response stays within `SETTLING_BAND` [s]; None
            when it does not within the measured time.
        steady_error: Mean error of the last tenth of the time [rad] or [m].
        rms_error: Root of the mean squared error [rad] or [m].
        peak_output: Largest magnitude of the controller's output, in its unit.
    """

    rise: float | None
    overshoot: float | None
    settling: float | None
    steady_error: float
    rms_error: float
    peak_output: float


def step_metrics(
    time: Array, actual: Array, output: Array, start: float, end: float
) -> ResponseMetrics:
    """Return the figures of a step response.

    Args:
        time: Time since the step [s], shape (n,), n >= 2; negative before it.
        actual: Measured position [rad] or [m], shape (n,).
        output: The controller's output, shape (n,).
        start: Position before the step.
        end: Position that was commanded; not equal to `start`.
    """
    after = time >= 0.0
    time, actual, output = time[after], actual[after], output[after]
    part = (actual - start) / (end - start)  # (n,): 0 at the start, 1 at the end
    return ResponseMetrics(
        rise=_rise(time, part),
        overshoot=max(0.0, float(np.max(part)) - 1.0),
        settling=_settling(time, part),
        steady_error=_steady(end - actual),
        rms_error=_rms(end - actual),
        peak_output=float(np.max(np.abs(output))),
    )


def tracking_metrics(desired: Array, actual: Array, output: Array) -> ResponseMetrics:
    """Return the figures of a motion that has no end, e.g. a sine.

    Args:
        desired: Commanded position [rad] or [m], shape (n,).
        actual: Measured position, shape (n,).
        output: The controller's output, shape (n,).
    """
    error = desired - actual
    return ResponseMetrics(
        rise=None,
        overshoot=None,
        settling=None,
        steady_error=_steady(error),
        rms_error=_rms(error),
        peak_output=float(np.max(np.abs(output))),
    )


def _rise(time: Array, part: Array) -> float | None:
    if not np.any(part >= 0.9):
        return None
    first = time[int(np.argmax(part >= 0.1))]
    return float(time[int(np.argmax(part >= 0.9))] - first)


def _settling(time: Array, part: Array) -> float | None:
    outside = np.flatnonzero(np.abs(part - 1.0) > SETTLING_BAND)
    if outside.size == 0:
        return 0.0
    last = int(outside[-1])
    return None if last + 1 >= time.size else float(time[last + 1])


def _steady(error: Array) -> float:
    return float(np.mean(error[-max(1, int(_TAIL * error.size)) :]))


def _rms(error: Array) -> float:
    return float(np.sqrt(np.mean(error**2)))
