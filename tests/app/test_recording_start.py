"""What a station records from its start, by its configuration."""

import importlib.util
import json
import threading

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.app.composition import compose
from station.app.recording_start import (
    describe,
    make_ports,
    make_recorder,
    recover_all,
)
from station.config import load_config
from station.records.record_store import RecordStore
from station.web.host_policy import HostPolicy
from tests.waiting import PATIENCE


@pytest.fixture
def build(tmp_path):
    """Return what builds a station and its recorder, and the warnings."""
    warnings = []

    def build(**records):
        config = load_config({
            "robot": {"type": "mock_hw/MockRobotHW", "joints": ["a"]},
            "controllers": {},
            "start": [],
            "records": {"directory": str(tmp_path), **records},
        })
        station = compose(config).station
        return config, station, make_recorder(station, config, warnings.append)

    build.warnings = warnings
    return build


def join_recovery():
    """Wait until no recovery runs in the background."""
    for thread in threading.enumerate():
        if thread.name == "recovery":
            thread.join(PATIENCE)
            assert not thread.is_alive()


def test_a_station_records_as_configured(build, tmp_path):
    _, _, recorder = build(max_count=7, incidents=3)

    assert recorder.store.folder == tmp_path
    assert recorder.store.quota.count == 7
    assert recorder.incidents.quota.count == 3
    assert build.warnings == []


def test_nothing_is_recorded_when_that_is_configured(build):
    assert build(enabled=False)[2] is None
    assert build(incidents=0)[2].incidents is None


def test_missing_packages_are_told(build, monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "mcap" else find(name)
    )

    assert build()[2] is None
    assert "mcap is not installed" in build.warnings[0]


def test_the_recordings_of_a_killed_station_are_recovered_and_told(build, tmp_path):
    _, station, recorder = build()
    join_recovery()  # that of the start, which finds nothing
    recorder.start("cut")
    station.loop.step(10)
    recorder.drain()
    assert recorder.store.recover() == []
    recorder._recording.give_up()  # as the system does with a process that is killed
    (tmp_path / "bad.json").write_text("{}")

    recover_all([recorder.store], station, build.warnings.append)

    assert len(build.warnings) == 2, build.warnings
    skipped, told = build.warnings
    assert "bad.json: it is the description of another file" in skipped
    assert "is recovered" in told
    (info,) = recorder.store.infos()
    assert (info.cycles, info.first_cycle, info.last_cycle) == (10, 1, 10)
    assert info.duration == pytest.approx(0.009)


def test_a_long_recovery_does_not_hold_the_start_up(build, monkeypatch):
    go_on = threading.Event()
    recover = RecordStore.recover
    monkeypatch.setattr(
        RecordStore, "recover", lambda *args: go_on.wait(PATIENCE) and recover(*args)
    )

    assert build()[2] is not None

    assert any(t.name == "recovery" for t in threading.enumerate())
    go_on.set()
    join_recovery()


@pytest.mark.parametrize("tool", ["foxglove", "rosbridge"])
@pytest.mark.parametrize(
    ("host", "anonymous"), [("127.0.0.1", True), ("192.0.2.7", False)]
)
def test_a_tool_is_served_as_configured(build, tool, host, anonymous):
    config, station, _ = build()
    policy = HostPolicy(origins=["https://mine.example"])
    app = create_app(station, Authenticator(), policy)
    assert make_ports(app, station, config, policy) == []
    section = getattr(config, tool).model_copy(
        update={
            "enabled": True,
            "host": host,
            "port": 9,
            "allowed_origins": ["https://tool.example"],
        }
    )
    config = config.model_copy(update={tool: section})

    (found,) = make_ports(app, station, config, policy)

    assert found.tool.lower() == tool
    assert (found.host, found.port) == (host, 9)
    assert found.place.anonymous is anonymous
    allowed = found.place.policy
    assert allowed.origins == {"https://mine.example", "https://tool.example"}


def test_a_recording_says_how_its_station_was_configured(build):
    config, station, _ = build()
    configuration = json.loads(describe(station, config)["/configuration"])

    assert configuration["robot"]["type"] == "mock_hw/MockRobotHW"
    assert "api" not in configuration
