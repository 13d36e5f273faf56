"""What the clients of the things a station keeps ask."""

import asyncio

import httpx
import pytest

from station.client.connection import AsyncConnection
from station.client.errors import ApiError
from station.client.stores import AsyncRecordingsClient
from station.reports import examples_of
from station.wire import ExperimentRequest, Recording, Recordings, Waypoint
from station.wire.experiments import Experiment
from tests.client.recorder import Recorder


def _recordings(answer):
    transport = httpx.MockTransport(answer)
    connection = AsyncConnection("http://station", "t", 1.0, transport)
    return AsyncRecordingsClient(connection)


def test_a_file_is_written_as_it_comes(tmp_path):
    def answer(request):
        assert request.url.path == "/api/v1/recordings/a/file"
        return httpx.Response(200, content=b"bytes")

    path = asyncio.run(_recordings(answer).download("a", tmp_path / "x"))

    assert path.read_bytes() == b"bytes"


def test_stopping_a_recording_that_failed_tells_why():
    failed = examples_of(Recording.__doc__)[0] | {
        "state": "failed",
        "error": "The disk is full.",
    }
    answer = Recordings.model_validate({"recordings": [failed]}).model_dump_json()
    recordings = _recordings(lambda _: httpx.Response(200, text=answer))

    with pytest.raises(LookupError, match="-pick failed: The disk is full"):
        asyncio.run(recordings.stop())


def test_a_refusal_makes_no_file(tmp_path):
    recordings = _recordings(lambda _: httpx.Response(404, content=b"{}"))

    with pytest.raises(ApiError):
        asyncio.run(recordings.download("a", tmp_path / "x"))
    assert not (tmp_path / "x").exists()


ALARM = {
    "id": 3,
    "subject": "stop",
    "severity": "warning",
    "text": "The station is stopped.",
    "remedy": "Release the stop.",
    "raised_at": 1.0,
    "cleared_at": None,
    "acknowledged_by": "",
    "acknowledged_at": None,
}


def test_alarms_are_listed_and_acknowledged():
    recorder = Recorder({"alarms": [ALARM], "unacknowledged": 1})
    assert recorder.run(lambda client: client.alarms.list())[0].id == 3
    assert recorder.requests == [("GET", "/api/v1/alarms", None)]
    recorder = Recorder(ALARM)
    assert recorder.run(lambda client: client.alarms.acknowledge(3)).id == 3
    assert recorder.requests == [("POST", "/api/v1/alarms/3/acknowledge", None)]


TOKEN = {"name": "ada", "role": "viewer", "created": 1.0, "expires_at": None}


def test_requests_of_tokens():
    recorder = Recorder({**TOKEN, "token": "secret", "tokens": [TOKEN]})

    recorder.run(lambda client: client.tokens.list())
    recorder.run(lambda client: client.tokens.create("ada", "viewer", expires=60.0))
    recorder.run(lambda client: client.tokens.revoke("ada"))

    assert recorder.requests == [
        ("GET", "/api/v1/tokens", None),
        (
            "POST",
            "/api/v1/tokens",
            {"name": "ada", "role": "viewer", "expires": 60.0},
        ),
        ("DELETE", "/api/v1/tokens/ada", None),
    ]


SET = {"name": "a", "saved_at": "now", "gains": {}, "differences": []}


@pytest.mark.parametrize(
    ("ask", "request_sent"),
    [
        (lambda sets: sets.get("a/b"), ("GET", "/gain-sets/a%2Fb", None)),
        (lambda sets: sets.save("a"), ("PUT", "/gain-sets/a", {})),
        (
            lambda sets: sets.save("a", ["x"]),
            ("PUT", "/gain-sets/a", {"controllers": ["x"]}),
        ),
        (lambda sets: sets.delete("a"), ("DELETE", "/gain-sets/a", None)),
    ],
)
def test_requests_of_a_set(ask, request_sent):
    recorder = Recorder(SET)

    assert recorder.run(lambda client: ask(client.gain_sets)).name == "a"

    method, path, body = request_sent
    assert recorder.requests == [(method, f"/api/v1{path}", body)]


def test_requests_that_change_gains():
    recorder = Recorder({"changes": {}})

    recorder.run(lambda client: client.gain_sets.apply("a", ["x"]))
    recorder.run(lambda client: client.gain_sets.undo())

    assert recorder.requests == [
        ("POST", "/api/v1/gain-sets/a/apply", {"controllers": ["x"]}),
        ("POST", "/api/v1/gain-sets/undo", None),
    ]


EXPERIMENT = examples_of(Experiment.__doc__)[0]
DONE = {**EXPERIMENT, "state": "done"}


@pytest.mark.parametrize(
    ("ask", "request_sent"),
    [
        (
            lambda e: e.start(ExperimentRequest(kind="tune", controller="arm")),
            ("POST", "", {"kind": "tune", "controller": "arm"}),
        ),
        (lambda e: e.get("a/b"), ("GET", "/a%2Fb", None)),
        (lambda e: e.wait("a"), ("GET", "/a", None)),
        (lambda e: e.cancel("a"), ("POST", "/a/cancel", None)),
        (lambda e: e.delete("a"), ("DELETE", "/a", None)),
    ],
)
def test_requests_of_an_experiment(ask, request_sent):
    recorder = Recorder(DONE)

    assert recorder.run(lambda client: ask(client.experiments)).name == "better"

    method, path, body = request_sent
    assert recorder.requests == [(method, f"/api/v1/experiments{path}", body)]


@pytest.mark.parametrize(
    ("ask", "path"),
    [
        (lambda e: e.trials("a", 5, 10), "/a/trials?after=5&count=10"),
        (lambda e: e.best("a", 1, "energy"), "/a/best?count=1&metric=energy"),
    ],
)
def test_trials_are_asked_for(ask, path):
    recorder = Recorder({"trials": [], "ended": 0})

    assert recorder.run(lambda client: ask(client.experiments)) == []

    assert recorder.requests == [("GET", f"/api/v1/experiments{path}", None)]


def test_gains_of_a_trial_are_applied_with_the_revisions_that_were_shown():
    recorder = Recorder({"changes": {}})

    recorder.run(lambda client: client.experiments.apply("a", "3f2a", {"arm": 4}))
    recorder.run(lambda client: client.gain_sets.set_gains({"arm": {"p": 1.0}}))

    assert recorder.requests == [
        (
            *("POST", "/api/v1/experiments/a/apply"),
            {"trial": "3f2a", "revisions": {"arm": 4}},
        ),
        (
            *("PATCH", "/api/v1/gains"),
            {"changes": {"arm": {"p": 1.0}}, "revisions": None},
        ),
    ]


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
