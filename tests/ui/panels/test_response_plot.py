"""The live charts."""

import numpy as np
import pytest

from station.ui.panels.response_plot import ResponsePlot
from station.ui.plot_history import PlotHistory
from tests.ui.views import sample


@pytest.fixture
def history():
    history = PlotHistory()
    for i in range(50):
        history.append(sample(0.1 * i, desired=1.0, actual=0.02 * i, error=0.5))
    return history


@pytest.fixture
def plot(bench):
    gui = bench.guarded.server.gui
    with gui.add_folder("Plot under test") as folder:
        plot = ResponsePlot(gui)
    yield plot
    folder.remove()


def test_desired_actual_and_error_are_drawn(plot, history):
    plot.show(history, 0, "rad")
    time, desired, actual = plot._response.data
    assert time[-1] == 0.0
    assert desired[-1] == 1.0
    assert actual[-1] == pytest.approx(0.98)
    assert np.all(plot._error.data[1] == 0.5)
    assert plot._response.series[1]["label"] == "desired [rad]"


def test_a_paused_view_stays(plot, history):
    plot.show(history, 0, "rad")
    plot._pause.value = True
    history.append(sample(99.0, desired=9.0))
    plot.show(history, 0, "rad")
    assert plot._response.data[1][-1] == 1.0


def test_an_empty_history_leaves_the_chart(plot):
    plot.show(PlotHistory(), 0, "rad")
    assert len(plot._response.data[0]) == 1
