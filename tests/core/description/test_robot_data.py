"""Where the robots of example-robot-data are looked for."""

from pathlib import Path

import pytest

from station.core.description import robot_data
from station.core.description.robot_data import (
    data_directories,
    fetched_directory,
    is_complete,
)


def test_installed_package_comes_before_what_was_fetched(tmp_path, monkeypatch):
    monkeypatch.setenv("STATION_ROBOT_DATA", str(tmp_path))
    (tmp_path / "example-robot-data/robots").mkdir(parents=True)

    installed, fetched = data_directories()

    assert (installed / "robots/ur_description").is_dir()
    assert fetched == fetched_directory()
    assert is_complete()


def test_without_either_there_is_none(tmp_path, monkeypatch):
    monkeypatch.setenv("STATION_ROBOT_DATA", str(tmp_path))
    monkeypatch.setattr(robot_data, "_installed_directory", lambda: None)

    assert data_directories() == []
    assert not is_complete()


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"STATION_ROBOT_DATA": "/a"}, "/a"),
        ({"XDG_DATA_HOME": "/b"}, "/b/control-station"),
        ({}, "/home/me/.local/share/control-station"),
    ],
)
def test_fetched_robots_are_in_the_users_directory(monkeypatch, variables, expected):
    for name in ("STATION_ROBOT_DATA", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", "/home/me")
    for name, value in variables.items():
        monkeypatch.setenv(name, value)

    assert fetched_directory() == Path(expected, "example-robot-data")
