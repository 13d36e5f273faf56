"""Environment variables name keys of the configuration."""

import pytest

from station.config.environment import read_environment
from station.core.config_error import ConfigError


@pytest.mark.parametrize(
    ("variable", "text", "path", "value"),
    [
        ("STATION_API__PORT", "8001", ("api", "port"), 8001),
        ("STATION_STATION__RATE", "5e2", ("station", "rate"), 500.0),
        ("STATION_ROBOT__ARM_ID", "left", ("robot", "arm_id"), "left"),
        ("STATION_UI__ENABLED", "false", ("ui", "enabled"), False),
        ("STATION_START", '["arm"]', ("start",), ["arm"]),
        ("STATION_ROBOT__BASE_XYZ", "[1.0, 0, 0]", ("robot", "base_xyz"), [1.0, 0, 0]),
        (
            "STATION_CONTROLLERS__ARM__TYPE",
            "a/B",
            ("controllers", "arm", "type"),
            "a/B",
        ),
    ],
)
def test_variable_sets_a_key(monkeypatch, variable, text, path, value):
    monkeypatch.setenv(variable, text)

    assert list(read_environment()) == [(path, value, variable)]


def test_other_variables_are_not_ours(monkeypatch):
    monkeypatch.setenv("STATION_TOKEN", "secret")
    monkeypatch.setenv("STATION_URL", "http://robot:8000")

    assert list(read_environment()) == []


def test_list_that_is_no_json_is_refused(monkeypatch):
    monkeypatch.setenv("STATION_START", "arm")

    with pytest.raises(ConfigError, match="STATION_") as caught:
        list(read_environment())

    assert '["arm"]' in caught.value.remedy


def test_value_with_two_meanings_is_refused(monkeypatch):
    monkeypatch.setenv("STATION_API__PORT", "08000")

    with pytest.raises(ConfigError, match="environment variable STATION_API__PORT"):
        list(read_environment())
