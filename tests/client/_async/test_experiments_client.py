"""Requests of the client of experiments."""

import pytest

from station.reports import examples_of
from station.wire import ExperimentRequest
from station.wire.experiments import Experiment
from tests.client.recorder import Recorder

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
