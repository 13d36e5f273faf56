"""A program of the same user finds a running station; nobody else does."""

import json
import os
import stat
import subprocess
import sys
from dataclasses import asdict, replace

import pytest

from station.local.private_files import (
    RuntimeDirectoryError,
    process_start,
    runtime_directory,
)
from station.local.station_locator import (
    RunningStation,
    find_running,
    write_runtime_file,
)

ME = RunningStation(
    url="http://127.0.0.1:8000",
    token="operator",
    viewer_token="viewer",
    ui_url="",
    boot_id="boot",
    pid=os.getpid(),
    started=process_start(os.getpid()),
)


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Let the runtime files be in a directory of the test."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path / "station"


def test_written_station_is_found():
    write_runtime_file(ME)

    assert find_running() == [ME]


def test_file_is_for_its_user_alone(directory):
    path = write_runtime_file(ME)

    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(directory.stat().st_mode) == 0o700


def test_no_directory_means_no_station(directory):
    assert find_running() == []
    assert not directory.exists()


def test_file_of_a_dead_process_is_removed():
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    path = write_runtime_file(replace(ME, pid=dead.pid))

    assert find_running() == []
    assert not path.exists()


def test_file_of_an_earlier_process_with_the_same_number_is_removed():
    path = write_runtime_file(replace(ME, started="1"))

    assert find_running() == []
    assert not path.exists()


def test_what_is_no_runtime_file_is_ignored(directory):
    write_runtime_file(ME)
    (directory / "broken.json").write_text("{")
    (directory / "other.json").write_text(json.dumps({**asdict(ME), "more": 1}))
    (directory / "list.json").write_text("[]")

    assert find_running() == [ME]


@pytest.mark.parametrize(
    "change",
    [
        {"pid": -1},
        {"pid": 0},
        {"pid": "1"},
        {"pid": 10**400},
        {"pid": 1.5},
        {"pid": True},
        {"url": 3},
        {"token": None},
        {"watchdog_url": ["http://127.0.0.1:1"]},
        {"started": {}},
    ],
)
def test_fields_of_the_wrong_kind_are_ignored(directory, change):
    write_runtime_file(ME)
    (directory / "nonsense.json").write_text(json.dumps({**asdict(ME), **change}))

    assert find_running() == [ME]


def test_what_is_no_plain_file_is_ignored(directory):
    write_runtime_file(ME)
    os.mkfifo(directory / "pipe.json")
    (directory / "folder.json").mkdir()
    (directory / "link.json").symlink_to(directory / f"{ME.pid}.json")
    (directory / "deep.json").write_text("[" * 60_000)
    (directory / "bytes.json").write_bytes(b"\xff\x00" * 100)

    assert find_running() == [ME]


def test_stations_are_listed_oldest_first():
    parent = replace(ME, pid=os.getppid(), started="", url="http://old")
    os.utime(write_runtime_file(parent), (1.0, 1.0))
    write_runtime_file(ME)

    assert [running.url for running in find_running()] == ["http://old", ME.url]


def test_link_in_the_place_of_the_file_is_not_followed(directory, tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("untouched")
    directory.mkdir(mode=0o700)
    (directory / f"{ME.pid}.json").symlink_to(victim)

    write_runtime_file(ME)

    assert victim.read_text() == "untouched"


@pytest.mark.parametrize("use", [find_running, lambda: write_runtime_file(ME)])
def test_directory_that_others_can_write_is_refused(directory, use):
    directory.mkdir()
    directory.chmod(0o777)

    with pytest.raises(RuntimeDirectoryError, match="not a directory of yours alone"):
        use()


def test_temporary_directory_serves_without_a_runtime_directory(monkeypatch):
    monkeypatch.delenv("XDG_RUNTIME_DIR")

    assert runtime_directory().name == f"station-{os.getuid()}"


def test_start_of_an_unknown_process_is_unknown():
    assert process_start(2**22 + 1) == ""
