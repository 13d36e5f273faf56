"""Wire models of waypoint paths and recordings."""

import math

import pytest
from pydantic import TypeAdapter, ValidationError

from station.reports import examples_of
from station.wire import (
    PlaybackPatch,
    PlayRequest,
    Recording,
    RecordingRequest,
    WaypointRequest,
)
from station.wire.base import FileName


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
        TypeAdapter(FileName).validate_python(name)


def test_a_recording_without_an_error_says_so():
    values = examples_of(Recording.__doc__)[0]
    assert Recording.model_validate({**values, "error": None}).error == ""


@pytest.mark.parametrize("name", ["-x", "a/b", "../x", "x" * 81])
def test_a_name_that_is_no_part_of_a_file_name_is_refused(name):
    with pytest.raises(ValidationError):
        RecordingRequest(name=name)
