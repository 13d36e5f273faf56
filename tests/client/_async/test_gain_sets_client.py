"""Requests of the client of gain sets."""

import pytest

from tests.client.recorder import Recorder

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
