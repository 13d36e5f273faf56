"""What a station records from its start, by its configuration."""

import importlib.util
import json

import pytest

from station.app.composition import compose
from station.app.recording_start import describe, make_recorder
from station.config import load_config


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


def test_the_recordings_of_a_killed_station_are_recovered_and_told(build):
    _, station, recorder = build()
    recorder.start("cut")
    station.loop.step(10)
    recorder.drain()
    build()

    (told,) = build.warnings
    assert "is recovered" in told


def test_a_recording_says_how_its_station_was_configured(build):
    config, station, _ = build()
    configuration = json.loads(describe(station, config)["/configuration"])

    assert configuration["robot"]["type"] == "mock_hw/MockRobotHW"
    assert "api" not in configuration
