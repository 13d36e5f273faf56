"""Waypoint paths over HTTP: captured, kept, played, paused, refused."""

from dataclasses import replace

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.client import ApiError, StationClient
from station.core.control.switching import SwitchRequest
from station.rehearsal.rehearsals import Policy, Rules
from station.wire import Waypoint
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.two_joint_station import make_station


@pytest.fixture(autouse=True)
def own_paths(monkeypatch, tmp_path):
    """Begin without any path."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))


@pytest.fixture
def station():
    station = make_station()
    station.switch_controllers(SwitchRequest(start=("arm",)))
    station.loop.step(3)
    return station


@pytest.fixture
def paths(station):
    """Return a client of the paths of a station whose trajectory controller runs."""
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        client.waypoint_paths.rehearsals = app.state.services.rehearsals
        yield client.waypoint_paths


def test_a_path_is_captured_edited_and_deleted(paths):
    paths.capture("wave")
    (captured,) = paths.capture("wave", "up", 1.5).waypoints[1:]
    assert captured.positions == pytest.approx({"j1": 0.0, "j2": 0.0})
    edited = replace(captured, positions={"j1": 0.4})
    assert paths.save("wave", [edited]).waypoints == [edited]
    assert paths.names() == ["wave"]
    assert paths.delete("wave").waypoints == [edited]
    assert paths.names() == []


def test_a_path_that_had_to_be_rehearsed_is_only_paused(paths):
    point = Waypoint(name="up", duration=0.5, positions={"j1": 0.4})
    paths.save("wave", [point])
    paths.play("wave")
    rehearsals = paths.rehearsals
    rehearsals.adopt(Rules(operator=Policy.REQUIRED))
    assert paths.change(paused=True, loop=False).state == "paused"
    for change in ({"paused": False}, {"speed": 2.0}, {"loop": True}):
        with pytest.raises(ApiError) as needed:
            paths.change(**change)
        assert (needed.value.status, needed.value.code) == (428, "rehearsal_needed")
    assert paths.cancel().state == "cancelled"


def test_a_path_is_played_paused_resumed_and_ends(paths, station):
    assert paths.playback() is None
    point = Waypoint(name="up", duration=0.5, positions={"j1": 0.4})
    paths.save("wave", [point])
    begun = paths.play("wave", speed=0.5, loop=True)
    assert (begun.state, begun.controller, begun.loop) == ("playing", "arm", True)
    station.loop.step(200)
    assert paths.change(paused=True).state == "paused"
    station.loop.step(300)
    held = station.latest().position[0]
    assert paths.change(paused=False, loop=False, speed=1.0).state == "playing"
    station.loop.step(1200)
    end = paths.playback()
    assert (end.state, end.rounds, end.progress) == ("succeeded", 1, 1.0)
    assert held < 0.39 < station.latest().position[0]


def test_a_path_is_cancelled(paths, station):
    paths.save("wave", [Waypoint(name="up", duration=2.0, positions={"j1": 0.4})])
    paths.play("wave")
    station.loop.step(500)
    assert paths.cancel().state == "cancelled"
    station.loop.step(300)
    held = station.latest().position[0]
    station.loop.step(300)
    assert station.latest().position[0] == pytest.approx(held, abs=1e-9)


@pytest.mark.parametrize(
    ("ask", "status", "code"),
    [
        (lambda p: p.get("nothing"), 404, "waypoint_path_not_found"),
        (lambda p: p.delete("nothing"), 404, "waypoint_path_not_found"),
        (lambda p: p.play("nothing"), 404, "waypoint_path_not_found"),
        (lambda p: p.cancel(), 409, "path_refused"),
        (lambda p: p.change(paused=True), 409, "path_refused"),
        (lambda p: p.capture("a b"), 422, "invalid_request"),
        (
            lambda p: p.save(
                "x", [Waypoint(name="a", duration=1.0, positions={"j3": 0.0})]
            ),
            422,
            "invalid_trajectory",
        ),
    ],
)
def test_what_is_not_possible_is_refused(paths, ask, status, code):
    with pytest.raises(ApiError) as caught:
        ask(paths)
    assert (caught.value.status, caught.value.code) == (status, code)
    assert paths.names() == []


def test_a_stopped_station_plays_nothing(paths, station):
    paths.save("wave", [Waypoint(name="up", duration=2.0, positions={"j1": 0.4})])
    station.stop("a test")
    station.loop.step()
    with pytest.raises(ApiError) as caught:
        paths.play("wave")
    assert caught.value.status in {409, 423}
    assert paths.playback() is None
