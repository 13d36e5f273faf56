"""One dashboard on a bench for all tests of a module."""

import pytest

from station.ui.teleoperation.viser_panel import NONE
from tests.ui.bench import Bench
from tests.ui.fake_station import SIMULATION, FakeStation


@pytest.fixture(scope="package")
def shared_bench():
    with Bench() as bench:
        yield bench


@pytest.fixture
def bench(shared_bench):
    """The bench, with nothing loaded and nothing said."""
    station = shared_bench.station
    station.controllers.clear()
    station.requests.clear()
    station.stop_state = "armed"
    station.simulation = dict(SIMULATION)
    station.arms = {}
    assert shared_bench.wait(lambda: _is_empty(shared_bench))
    return shared_bench


@pytest.fixture
def client(shared_bench):
    """The bench's browser, over whose robot the dashboard itself lays nothing."""
    server, views = shared_bench.guarded.server, shared_bench.dashboard.views
    server.get_event_loop().call_soon_threadsafe(views.choose, "", ())
    assert shared_bench.wait(lambda: not views.wanted())
    return next(iter(server.get_clients().values()))


def _is_empty(bench):
    """Return whether the panel shows that nothing is loaded and all may move."""
    view = bench.link.view()
    shown = [
        bench.dashboard.sliders.teleoperation.joints.controllers,
        bench.dashboard.gains.chosen.value != NONE,
        bench.dashboard.gains.sliders,
    ]
    return not view.controllers and not view.blocked() and not any(shown)


@pytest.fixture
def fake_station():
    with FakeStation() as station:
        yield station
