"""Requests of the client of waypoint paths."""

import pytest

from station.wire import Waypoint
from tests.client.recorder import Recorder

PATH = {"name": "a", "saved_at": "now", "waypoints": []}
PLAYBACK = {
    "path": "a",
    "controller": "arm",
    "state": "playing",
    "speed": 1.0,
    "loop": False,
    "rounds": 0,
    "waypoint": 0,
    "waypoints": 1,
    "progress": 0.0,
    "remaining": 1.0,
    "message": "",
}
POINT = {"name": "up", "duration": 1.0, "positions": {"j": 0.5}}


@pytest.mark.parametrize(
    ("ask", "request_sent"),
    [
        (lambda p: p.get("a/b"), ("GET", "/waypoint-paths/a%2Fb", None)),
        (lambda p: p.delete("a"), ("DELETE", "/waypoint-paths/a", None)),
        (
            lambda p: p.save("a", [Waypoint(**POINT)]),
            ("PUT", "/waypoint-paths/a", {"waypoints": [POINT]}),
        ),
        (
            lambda p: p.capture("a", "up"),
            ("POST", "/waypoint-paths/a/capture", {"name": "up", "duration": 2.0}),
        ),
    ],
)
def test_requests_of_a_path(ask, request_sent):
    recorder = Recorder(PATH)
    assert recorder.run(lambda client: ask(client.waypoint_paths)).name == "a"
    method, path, body = request_sent
    assert recorder.requests == [(method, f"/api/v1{path}", body)]


def test_requests_of_the_playing():
    recorder = Recorder(PLAYBACK)
    recorder.run(lambda client: client.waypoint_paths.play("a", loop=True))
    recorder.run(lambda client: client.waypoint_paths.change(paused=True))
    recorder.run(lambda client: client.waypoint_paths.cancel())
    assert [(m, p) for m, p, _ in recorder.requests] == [
        ("POST", "/api/v1/waypoint-paths/a/play"),
        ("PATCH", "/api/v1/playback"),
        ("DELETE", "/api/v1/playback"),
    ]
    assert recorder.requests[0][2]["loop"] is True
    assert recorder.requests[1][2]["paused"] is True
