"""Waypoint paths on the wire: what is no waypoint, no speed and no name."""

import math

import pytest
from pydantic import TypeAdapter, ValidationError

from station.wire import PlaybackPatch, PlayRequest, WaypointRequest
from station.wire.waypoint_paths import PathName


@pytest.mark.parametrize(
    "change",
    [
        {"duration": 0.0},
        {"duration": 601.0},
        {"duration": math.nan},
        {"positions": {}},
        {"positions": {"j": math.inf}},
        {"positions": {"j": "0.1"}},
        {"name": ""},
        {"speed": 1.0},
    ],
)
def test_what_is_no_waypoint_is_refused(change):
    point = {"name": "up", "duration": 1.0, "positions": {"j": 0.1}}
    assert WaypointRequest.model_validate(point).duration == 1.0
    with pytest.raises(ValidationError):
        WaypointRequest.model_validate({**point, **change})


@pytest.mark.parametrize("speed", [0.0, 0.04, 2.1, -1.0, math.nan])
def test_a_speed_has_bounds(speed):
    for model in (PlayRequest, PlaybackPatch):
        assert model(speed=2.0).speed == 2.0
        with pytest.raises(ValidationError):
            model(speed=speed)


@pytest.mark.parametrize("name", ["", ".", "-a", "a/b", "a b", "x" * 101])
def test_names_are_segments_of_a_path(name):
    with pytest.raises(ValidationError):
        TypeAdapter(PathName).validate_python(name)
