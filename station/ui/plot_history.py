"""The last seconds of a controller's samples, thinned out for a chart."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.wire import ControllerSample

MAX_POINTS = 500
"""Most points of a chart; a browser cannot redraw more points in time."""
_CAPACITY = 6000

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Curves:
    """The curves of a chart, shape (n,) each, n <= `MAX_POINTS`.

    Attributes:
        time: Time before now [s], <= 0, ascending.
        desired: Set-point; NaN where there is none.
        actual: Measured value.
        error: Difference between set-point and measured value.
    """

    time: Array
    desired: Array
    actual: Array
    error: Array


class PlotHistory:
    """Keeps the samples of one controller; a restart of the station clears it."""

    def __init__(self) -> None:
        self._samples: deque[ControllerSample] = deque(maxlen=_CAPACITY)

    def append(self, sample: ControllerSample) -> None:
        """Keep a sample; a sample older than the last one clears the history first."""
        if self._samples:
            last = self._samples[-1]
            if sample.stamp == last.stamp:
                return
            if sample.stamp < last.stamp or sample.name != last.name:
                self._samples.clear()
        self._samples.append(sample)

    @property
    def names(self) -> list[str]:
        """Names of the elements of the samples, such as joints."""
        return self._samples[-1].name if self._samples else []

    def curves(self, index: int, window: float) -> Curves:
        """Return the newest part of one element's history.

        Args:
            index: Index of the element.
            window: How far to look back [s], > 0.
        """
        samples = list(self._samples)
        if not samples:
            empty = np.zeros(0)
            return Curves(empty, empty, empty, empty)
        end = samples[-1].stamp
        rows = [
            (s.stamp - end, s.desired[index], s.actual[index], s.error[index])
            for s in samples
            if s.stamp >= end - window
        ]
        table = np.array(rows, dtype=np.float64)  # (n, 4); None becomes NaN
        table = table[_kept(table, MAX_POINTS)]
        return Curves(table[:, 0], table[:, 1], table[:, 2], table[:, 3])


class AxisRange:
    """Ends of a y axis that change seldom, because a chart is rebuilt when they do.

    Args:
        least: Smallest span, so that the noise of a constant does not fill the chart.
    """

    def __init__(self, least: float = 0.02) -> None:
        self._least = least
        self._ends = (0.0, 0.0)

    def fit(self, *curves: Array) -> tuple[float, float]:
        """Return ends that enclose all finite values of `curves` with a margin."""
        values = np.concatenate(curves)
        values = values[np.isfinite(values)]
        if not len(values):
            return self._ends if self._ends != (0.0, 0.0) else (-1.0, 1.0)
        low, high = float(values.min()), float(values.max())
        span = max(high - low, self._least)
        first, last = self._ends
        fits = first <= low and high <= last and last - first < 4.0 * span
        if not fits:
            middle = 0.5 * (low + high)
            step = 10.0 ** math.floor(math.log10(span)) / 2.0
            reach = 0.7 * span
            first = step * math.floor((middle - reach) / step)
            last = step * math.ceil((middle + reach) / step)
            self._ends = (round(first, 9), round(last, 9))
        return self._ends


def _kept(table: Array, limit: int) -> NDArray[np.intp]:
    """Return the indices of the rows to draw, so that no peak of the curves is lost.

    Each bucket of rows keeps the rows where `actual` and `error` have their smallest
    and largest value.

    Args:
        table: Rows of time, desired, actual, error, shape (n, 4).
        limit: Most rows to keep.
    """
    n = len(table)
    if n <= limit:
        return np.arange(n)
    kept: set[int] = {0, n - 1}
    for bucket in np.array_split(np.arange(n), max((limit - 2) // 4, 1)):
        part = np.nan_to_num(table[bucket])
        for column in (2, 3):
            kept.add(int(bucket[part[:, column].argmin()]))
            kept.add(int(bucket[part[:, column].argmax()]))
    return np.array(sorted(kept))
