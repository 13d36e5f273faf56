"""Desired against actual, and their difference, of one joint: two live charts."""

import numpy as np
import viser
from viser import uplot

from station.ui.plot_history import AxisRange, Curves, PlotHistory

_WINDOWS = {"5 s": 5.0, "10 s": 10.0, "30 s": 30.0}
_AXES = (uplot.Axis(), uplot.Axis(size=56, space=22))
_PADDING = (12, 20, 0, 0)
_EMPTY = np.zeros(1)
_BLUE, _ORANGE, _RED = "#228be6", "#f08c00", "#e03131"


class ResponsePlot:
    """Two charts above each other, with window and pause.

    Pausing freezes the view only; recording goes on.

    Args:
        gui: Where the charts are built.
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        self._shown = (0, "", 0.0)
        self._response_range, self._error_range = AxisRange(), AxisRange()
        self._response = gui.add_uplot(
            (_EMPTY, _EMPTY, _EMPTY),
            _response_series(""),
            height=170,
            scales=_scales(5.0, (-1.0, 1.0)),
            padding=_PADDING,
            axes=_AXES,
        )
        self._error = gui.add_uplot(
            (_EMPTY, _EMPTY),
            _error_series(""),
            height=110,
            scales=_scales(5.0, (-1.0, 1.0)),
            padding=_PADDING,
            axes=_AXES,
        )
        self._window = gui.add_dropdown("Window", tuple(_WINDOWS))
        self._pause = gui.add_checkbox("Pause", initial_value=False)

    def show(self, history: PlotHistory, index: int, unit: str) -> None:
        """Draw the newest part of one element's history.

        Args:
            history: The controller's samples.
            index: Which element.
            unit: Its unit.
        """
        if self._pause.value:
            return
        window = _WINDOWS[self._window.value]
        if (index, unit, window) != self._shown:
            self._shown = (index, unit, window)
            self._response.series = _response_series(unit)
            self._error.series = _error_series(unit)
        curves = history.curves(index, window)
        if len(curves.time):
            self._draw(curves, window)

    def _draw(self, curves: Curves, window: float) -> None:
        ends = self._response_range.fit(curves.desired, curves.actual)
        self._response.scales = _scales(window, ends)
        self._error.scales = _scales(window, self._error_range.fit(curves.error))
        self._response.data = (curves.time, curves.desired, curves.actual)
        self._error.data = (curves.time, curves.error)


def _response_series(unit: str) -> tuple[uplot.Series, ...]:
    in_unit = f" [{unit}]" if unit else ""
    return (
        uplot.Series(label="t [s]"),
        uplot.Series(label=f"desired{in_unit}", stroke=_ORANGE, width=2, dash=(6, 4)),
        uplot.Series(label=f"actual{in_unit}", stroke=_BLUE, width=2),
    )


def _error_series(unit: str) -> tuple[uplot.Series, ...]:
    in_unit = f" [{unit}]" if unit else ""
    return (
        uplot.Series(label="t [s]"),
        uplot.Series(label=f"error{in_unit}", stroke=_RED, width=1.5),
    )


def _scales(window: float, ends: tuple[float, float]) -> dict[str, uplot.Scale]:
    return {
        "x": uplot.Scale(time=False, range=(-window, 0.0)),
        "y": uplot.Scale(range=ends),
    }
