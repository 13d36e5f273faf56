"""Verb `ui`: the dashboard for a station, or the reason why not."""

import os

import pytest

from station.app.orphaned_dashboard import StationWatch

pytest.importorskip("station.ui.main")


@pytest.fixture
def dashboards(monkeypatch):
    """Return the list of what dashboards were started with."""
    started = []

    def run_dashboard(config, on_ready):
        started.append(config)
        on_ready("http://127.0.0.1:8080")
        return 0

    monkeypatch.setattr("station.ui.main.run_dashboard", run_dashboard)
    monkeypatch.setenv("STATION_TOKEN", "secret")
    return started


def test_dashboard_is_run_for_the_station(run, dashboards):
    outcome = run("ui --connect http://robot:8000 --port 0 --arm-id left")

    (config,) = dashboards
    assert outcome.code == 0
    assert "http://127.0.0.1:8080" in outcome.out
    assert (config.url, config.token) == ("http://robot:8000", "secret")
    assert (config.port, config.arm_id, config.follower) == (0, "left", None)


def test_child_of_a_station_is_quiet_and_follows_it(run, dashboards, monkeypatch):
    monkeypatch.setattr(StationWatch, "start", lambda _: True)
    parent = f"--parent-pid {os.getppid()} --watchdog http://127.0.0.1:9"
    outcome = run(f"ui --connect http://robot:8000 {parent}")

    (config,) = dashboards
    assert outcome.out == ""
    assert config.watchdog_url == "http://127.0.0.1:9"
    assert config.follower.access.token == "secret"


def test_child_of_a_station_that_is_gone_does_not_start(run, dashboards):
    assert run(f"ui --connect http://robot:8000 --parent-pid {os.getpid()}").code == 0
    assert dashboards == []


@pytest.mark.usefixtures("dashboards")
def test_dashboard_needs_a_token(run, monkeypatch, tmp_path):
    monkeypatch.delenv("STATION_TOKEN")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))

    outcome = run("ui --connect http://robot:8000")

    assert outcome.code == 1
    assert "STATION_TOKEN" in outcome.err


@pytest.mark.usefixtures("dashboards")
def test_taken_port_is_told(run, monkeypatch):
    def taken(*_):
        raise OSError(98, "Address already in use")

    monkeypatch.setattr("station.ui.main.run_dashboard", taken)

    outcome = run("ui --connect http://robot:8000 --port 8080")

    assert outcome.code == 1
    assert "127.0.0.1:8080: Address already in use" in outcome.err
