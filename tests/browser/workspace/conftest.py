"""One default station and one window for all files; each finds both as just started."""

from contextlib import contextmanager

import pytest

from station.client import StationClient
from tests.browser.conftest import opened, run_station
from tests.browser.workspace_page import allow_motion, run_alone, without_scene


@pytest.fixture(scope="package")
def shared_station(tmp_path_factory):
    """The station, and a function that lets it be as one that has just started."""
    with run_station(tmp_path_factory.mktemp("station")) as running:
        with StationClient(running.api, running.token) as client:
            names = [one.name for one in client.controllers()]
            gains = {name: client.gains(name).values for name in names}

        def restore():
            with StationClient(running.api, running.token) as client:
                _restore(client, gains)

        yield running, restore


@pytest.fixture(scope="module")
def running_station(shared_station):
    """The station of the folder, which has nothing of other files but their events."""
    running, restore = shared_station
    restore()
    return running


@pytest.fixture(scope="package")
def window(browser):
    """A window, which costs half as much as the page in it."""
    with browser.new_context(viewport={"width": 1280, "height": 800}) as context:
        without_scene(context)
        context.new_page()  # It stays: a window closes with its last tab.
        yield context


@pytest.fixture(scope="module")
def open_tab(window, running_station):
    """A function that opens the dashboard in a tab, where nothing is kept of others."""

    @contextmanager
    def open_one(begin=lambda _: None):
        def begin_anew(page):
            devtools = window.new_cdp_session(page)
            kept = {"origin": running_station.ui, "storageTypes": "local_storage"}
            devtools.send("Storage.clearDataForOrigin", kept)
            devtools.detach()
            begin(page)

        with opened(window, running_station, begin_anew) as page:
            yield page

    return open_one


@pytest.fixture(scope="module")
def workspace_tab(open_tab):
    """The workspace, logged in; a script error on the page fails the last test."""
    with open_tab() as page:
        yield page


def _restore(client, gains):
    client.lease.act_under(client.lease.take("the next file", force=True).lease)
    allow_motion(client)
    run_alone(client)
    for name in {one.name for one in client.controllers()} - gains.keys():
        client.unload_controller(name)
    for name, values in gains.items():
        if values:
            client.set_gains(name, values)
    panda = client.robot("panda")
    panda.guiding(pressed=False)
    panda.user_stop(pressed=False)
    client.simulation.reset()
    _forget(client)
    client.lease.release()


def _forget(client):
    """Delete what the station has kept for its users."""
    for kept in (client.gain_sets, client.plot_layouts, client.waypoint_paths):
        for name in kept.names():
            kept.delete(name)
    for recording in client.recordings.list():
        client.recordings.delete(recording.identifier)
    for runs in (client.bench_runs, client.experiments):
        for one in runs.list():
            runs.delete(one.name)
    for alarm in client.alarms.list():
        client.alarms.acknowledge(alarm.id)
    for token in client.tokens.list():
        client.tokens.revoke(token.name)
