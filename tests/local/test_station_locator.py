"""The right station is found, with its token."""

import os
from dataclasses import replace

import pytest

from station.client import StationClient
from station.local.private_files import process_start
from station.local.station_locator import (
    NoStationError,
    RunningStation,
    StationAddressError,
    locate,
    watchdog_of,
    write_runtime_file,
)

ME = os.getpid()
LOCAL = RunningStation(
    "http://127.0.0.1:8000", "operator", "viewer", "", "boot", ME, process_start(ME)
)


@pytest.fixture(autouse=True)
def nothing_set(tmp_path, monkeypatch):
    """Let no station run and nothing be set."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.delenv("STATION_URL", raising=False)
    monkeypatch.delenv("STATION_TOKEN", raising=False)


def test_local_station_is_found_with_its_token():
    write_runtime_file(LOCAL)

    assert locate(None, None) == ("http://127.0.0.1:8000", "operator")
    assert locate(None, "mine") == ("http://127.0.0.1:8000", "mine")


def test_no_station_is_an_error():
    with pytest.raises(NoStationError, match="No station runs") as caught:
        locate(None, None)

    assert "station run" in caught.value.remedy


def test_of_two_stations_one_must_be_chosen():
    write_runtime_file(LOCAL)
    other = replace(LOCAL, url="http://127.0.0.1:9000", pid=os.getppid(), started="")
    write_runtime_file(replace(other, token="other"))

    with pytest.raises(NoStationError, match="2 stations run"):
        locate(None, None)
    assert locate("http://127.0.0.1:9000/", None)[1] == "other"


@pytest.mark.parametrize("url", ["http://127.0.0.1:8000", "http://localhost:8000"])
def test_token_of_a_local_url_is_found(url):
    write_runtime_file(LOCAL)

    assert locate(url, None) == (url, "operator")


def test_token_stays_on_this_machine():
    write_runtime_file(LOCAL)

    assert locate("http://elsewhere:8000", None) == ("http://elsewhere:8000", None)


def test_environment_names_the_station(monkeypatch):
    monkeypatch.setenv("STATION_URL", "http://robot:8000")
    monkeypatch.setenv("STATION_TOKEN", "remote")

    assert locate(None, None) == ("http://robot:8000", "remote")
    assert locate("http://other:1", "t") == ("http://other:1", "t")


@pytest.mark.parametrize("url", ["robot:8000", "ftp://robot", "http://", "robot"])
def test_what_is_no_url_is_refused(url):
    with pytest.raises(StationAddressError, match="is not the URL of a station"):
        locate(url, None)


def test_the_watchdog_of_a_local_station_is_found():
    write_runtime_file(replace(LOCAL, watchdog_url="http://127.0.0.1:9"))

    assert watchdog_of("http://localhost:8000") == "http://127.0.0.1:9"
    assert watchdog_of("http://127.0.0.1:8001") == ""


def test_client_without_arguments_is_that_of_the_local_station():
    write_runtime_file(LOCAL)

    with StationClient() as client:
        assert client.url == "http://127.0.0.1:8000"
        assert client.stream("loop").options.token == "operator"
