"""The dashboard outlives a crash of its station, for a while and for one user alone."""

import os
import signal
import time

import httpx
import pytest

from tests.stopwatch import Stopwatch
from tests.system.station_process import StationProcess, is_alive, wait_for_end
from tests.waiting import wait_until

pytestmark = pytest.mark.long

RECONNECTED = 3.0
"""What is promised, from the answer of the new station's API on [s]."""


@pytest.fixture
def start(tmp_path):
    """Return a function that starts a station with a dashboard."""
    stations = []

    def start_station(*arguments, window=60.0):
        path = tmp_path / "station.yaml"
        path.write_text(f"ui: {{reconnect_window: {window}}}\n")
        station = StationProcess(tmp_path, str(path), *arguments)
        stations.append(station)
        return station

    yield start_station
    for station in stations:
        station.clean_up()


@pytest.fixture
def browser():
    """Return a browser without a session."""
    with httpx.Client(follow_redirects=True, timeout=5.0) as client:
        yield client


def log_in(browser, station):
    """Log in to the dashboard of a station; return its address."""
    url = station.told(1)["ui_ready"]
    token = station.access()["token"]
    assert browser.get(f"{url}/login", params={"token": token}).status_code == 200
    assert browser.get(f"{url}/session").json() == {"role": "operator"}
    return url


def wait_until_live(browser, url):
    """Wait until the dashboard shows live data."""
    assert wait_until(lambda: browser.get(f"{url}/state").json().get("link") == "live")


def test_sessions_outlive_a_crash_and_the_dashboard_follows_the_next_station(
    start, browser
):
    crashed = start(window=61.0)
    crashed.told(1)
    other = crashed.child("ui")
    port = crashed.access()["ui_url"].rpartition(":")[2]
    crashed.end(signal.SIGKILL)

    # What draws something else is not adopted.
    first = start("--ui-port", port)
    url = log_in(browser, first)
    dashboard = first.child("ui")
    assert not is_alive(other)
    assert dashboard != other
    wait_until_live(browser, url)
    first.end(signal.SIGKILL)
    assert browser.get(f"{url}/session").json() == {"role": "operator"}

    second = start()
    access = second.access()
    with Stopwatch(second.process.pid, dashboard, os.getpid()) as watch:
        wait_until_live(browser, url)

    assert access["ui_url"] == url
    assert is_alive(dashboard)
    assert watch.seconds < RECONNECTED
    assert browser.get(f"{url}/session").json() == {"role": "operator"}

    # The stop works while the interpreter of the station is stopped.
    second.process.send_signal(signal.SIGSTOP)
    answer = browser.post(f"{url}/stop", headers={"Origin": url})
    second.process.send_signal(signal.SIGCONT)
    assert answer.status_code == 200, answer.text
    assert answer.json()["state"] == "stopped"
    assert wait_until(
        lambda: browser.get(f"{url}/state").json()["stop_state"] == "stopped"
    )

    second.end(signal.SIGINT)
    assert second.process.returncode == 0, second.errors
    assert not is_alive(dashboard)


def test_dashboard_that_nobody_adopts_ends(start):
    station = start(window=1.0)
    station.told(1)
    dashboard = station.child("ui")
    folder = station.runtime_folder

    station.end(signal.SIGKILL)

    assert wait_for_end(dashboard, 20.0)
    assert list(folder.glob("*.dashboard")) == []


@pytest.mark.parametrize("delay", [0.0, 0.3, 0.8])
def test_dashboard_that_still_imports_ends_with_a_killed_station(start, delay):
    station = start()
    dashboard = station.child("ui")
    time.sleep(delay)

    station.end(signal.SIGKILL)

    assert wait_for_end(dashboard, 5.0)
