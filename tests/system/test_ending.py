"""Ctrl-C ends everything that `station run` started, quickly and quietly."""

import contextlib
import os
import signal
import socket
import threading
from pathlib import Path

import pytest

from station.client import ApiError, StationClient
from tests.system import hung_controllers
from tests.system.station_process import StationProcess, is_alive
from tests.waiting import wait_until

SLOW = f"{hung_controllers.__name__}:NeverLoadedController"
SOON = 3.0
"""What is promised for an end [s]."""


@pytest.fixture
def start(tmp_path):
    """Return a function that starts a station."""
    stations = []

    def start_station(*arguments):
        station = StationProcess(tmp_path, *arguments)
        stations.append(station)
        return station

    yield start_station
    for station in stations:
        station.clean_up()


@pytest.fixture
def watch():
    """Return a function that reads a stream in a thread until it ends."""
    threads = []

    def watch_stream(access, rate):
        first = threading.Event()

        def read():
            client = StationClient(access["url"], access["token"])
            with client, client.stream("joint_states", rate=rate, reconnect=False) as s:
                try:
                    for _ in s:
                        first.set()
                except ApiError:
                    return

        thread = threading.Thread(target=read)
        thread.start()
        threads.append(thread)
        assert first.wait(60.0)

    yield watch_stream
    for thread in threads:
        thread.join(60.0)


def test_ctrl_c_ends_everything_with_open_streams(start, watch):
    station = start()
    access = station.access()
    station.told(1)
    dashboard = station.child("ui")
    for rate in (50.0, 100.0, "full"):
        watch(access, rate)

    duration = station.end(signal.SIGINT)

    assert station.process.returncode == 0, station.errors
    assert duration < SOON
    assert "Traceback" not in station.errors
    assert not is_alive(dashboard)
    assert not Path(station.told(0)["runtime_file"]).exists()


@pytest.mark.long
def test_termination_ends_it_likewise_and_the_command_line_tells_its_absence(
    start, watch
):
    station = start("--no-ui")
    watch(station.access(), "full")
    found = station.command("list_controllers")

    duration = station.end(signal.SIGTERM)
    lost = station.command("list_controllers")

    assert station.process.returncode == 0, station.errors
    assert duration < SOON
    assert "Traceback" not in station.errors
    assert (found.returncode, found.stderr) == (0, "")
    assert "joint_state_controller" in found.stdout
    assert lost.returncode == 1
    assert "No station runs" in lost.stderr


@pytest.mark.long
def test_stuck_dashboard_does_not_hold_it_up(start):
    station = start()
    station.told(1)
    dashboard = station.child("ui")
    os.kill(dashboard, signal.SIGSTOP)

    duration = station.end(signal.SIGINT)

    assert station.process.returncode == 0, station.errors
    assert duration < SOON
    assert not is_alive(dashboard)


@pytest.mark.long
def test_request_that_never_comes_back_does_not_hold_the_end_up(start, tmp_path):
    config, mark = tmp_path / "station.yaml", tmp_path / "loading"
    module = hung_controllers.__name__
    config.write_text(f"station: {{controller_modules: [{module}]}}")
    station = start("--no-ui", str(config))
    access = station.access()

    def load():
        client = StationClient(access["url"], access["token"], timeout=60.0)
        with client, contextlib.suppress(ApiError):
            client.load_controller("slow", SLOW, {"mark": str(mark)})

    thread = threading.Thread(target=load)
    thread.start()
    assert wait_until(mark.exists)
    duration = station.end(signal.SIGINT)
    thread.join(60.0)

    assert station.process.returncode == 0, station.errors
    assert duration < SOON
    assert "Traceback" not in station.errors


@pytest.mark.long
def test_second_signal_ends_it_at_once(start):
    station = start("--no-ui")
    station.access()
    station.process.send_signal(signal.SIGINT)

    station.end(signal.SIGINT)

    assert station.process.returncode in {0, 128 + signal.SIGINT}
    assert "Traceback" not in station.errors


@pytest.mark.long
def test_signal_during_the_start_ends_it(start):
    station = start("--no-ui")

    station.end(signal.SIGTERM)

    assert station.process.returncode in {0, -signal.SIGTERM}
    assert "Traceback" not in station.errors


@pytest.mark.long
def test_taken_port_is_told(start):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        station = start("--no-ui", "--port", port)
        station.process.wait(90.0)

    assert station.process.returncode == 1
    assert port in station.errors
    assert "Traceback" not in station.errors
