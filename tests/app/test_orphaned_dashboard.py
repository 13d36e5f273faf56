"""A dashboard that outlived its station is found by one other station."""

import os
import subprocess
import sys
from dataclasses import replace

import pytest

from station.app.orphaned_dashboard import (
    DashboardRecord,
    claim_orphan,
    dashboard_path,
    read_dashboard,
)
from station.local.private_files import process_start

ME = os.getpid()
HOST = "127.0.0.1"


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Let the runtime files be in a directory of the test."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


@pytest.fixture
def ended():
    """Return the number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


@pytest.fixture
def orphan(ended):
    """Return a dashboard, which is this process, whose station has ended."""
    record = DashboardRecord(
        pid=ME,
        started=process_start(ME),
        host=HOST,
        port=8080,
        shown="panda",
        station_pid=ended,
        station_started="1",
        api_url="http://127.0.0.1:8000",
        token="secret",
        watchdog_url="",
    )
    record.write()
    return record


@pytest.mark.parametrize("port", [0, 8080])
def test_an_orphan_is_claimed_once(orphan, port):
    assert claim_orphan(HOST, port) == orphan
    assert claim_orphan(HOST, port) is None
    assert read_dashboard(ME) is None
    assert list(dashboard_path(ME).parent.iterdir()) == []


def test_a_dashboard_elsewhere_is_none_of_ours(orphan):
    assert claim_orphan(HOST, 8081) is None
    assert claim_orphan("0.0.0.0", 0) is None
    assert read_dashboard(ME) == orphan


def test_a_dashboard_whose_station_runs_is_left_alone(orphan):
    parent = os.getppid()
    changes = {"station_pid": parent, "station_started": process_start(parent)}
    replace(orphan, **changes).write()

    assert claim_orphan(HOST, 8080) is None


def test_the_file_of_a_dashboard_that_ended_is_removed(orphan, ended):
    dashboard_path(ME).unlink()
    path = replace(orphan, pid=ended).write()

    assert claim_orphan(HOST, 0) is None
    assert not path.exists()


def test_nonsense_is_skipped(orphan):
    (dashboard_path(ME).parent / "1.dashboard").write_text("[]")

    assert claim_orphan(HOST, 0) == orphan


def test_no_directory_means_no_dashboard():
    assert claim_orphan(HOST, 0) is None
