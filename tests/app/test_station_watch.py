"""The dashboard's eye on its station, in processes of their own."""

import os
import subprocess
import sys

import pytest

from station.app.orphaned_dashboard import DashboardRecord, StationWatch
from station.local.private_files import process_start
from station.ui.link.station_access import StationAccess
from tests.waiting import PATIENCE, wait_until

ACCESS = StationAccess("http://127.0.0.1:8000", "secret", "")
PROGRAM = """
import sys, time
from station.app.orphaned_dashboard import StationWatch
from station.ui.link.station_access import StationAccess
import os
watch = StationWatch(os.getppid(), StationAccess("http://old", "secret", ""), WINDOW)
assert watch.start()
watch.is_serving = SERVING
print(os.getpid(), flush=True)
lost = False
while not watch.is_over:
    access = watch.access
    if access is None and not lost:
        lost = True
        print("lost", flush=True)
    if access is not None and access.url != "http://old":
        print(access.url, access.token, access.viewer_token, flush=True)
        break
    time.sleep(0.02)
"""
STATION = """
import subprocess, sys
child = subprocess.Popen([sys.executable, "-c", sys.argv[1]])
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Let the runtime files be in a directory of the test."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


@pytest.fixture
def start():
    """Return a function that starts a station with its dashboard."""
    stations = []

    def start_both(*, window=60.0, serving=True):
        program = PROGRAM.replace("WINDOW", str(window))
        station = subprocess.Popen(
            [sys.executable, "-c", STATION, program.replace("SERVING", str(serving))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        stations.append(station)
        return station, int(station.stdout.readline())

    yield start_both
    for station in stations:
        station.stdin.close()
        station.wait(PATIENCE)
        station.stdout.close()


def ends(pid):
    return wait_until(lambda: not process_start(pid))


def test_a_dashboard_that_starts_ends_with_its_station(start):
    station, dashboard = start(serving=False)

    station.kill()

    assert ends(dashboard)


def test_a_dashboard_that_serves_ends_when_its_time_is_up(start):
    station, dashboard = start(window=0.3)

    station.kill()
    station.wait()
    assert process_start(dashboard)

    assert ends(dashboard)


def test_a_dashboard_that_serves_learns_of_the_station_that_adopts_it(start):
    station, dashboard = start()
    station.kill()
    station.wait()
    assert station.stdout.readline() == "lost\n"

    DashboardRecord(
        pid=dashboard,
        started=process_start(dashboard),
        host="127.0.0.1",
        port=8080,
        shown="",
        station_pid=os.getpid(),
        station_started=process_start(os.getpid()),
        api_url="http://new",
        token="fresh",
        watchdog_url="",
        viewer_token="looks",
    ).write()

    assert station.stdout.readline().split() == ["http://new", "fresh", "looks"]


def test_a_watch_is_not_begun_for_a_station_that_has_ended():
    assert not StationWatch(os.getpid(), ACCESS, 1.0).start()
