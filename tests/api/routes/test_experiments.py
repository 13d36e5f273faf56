"""Experiments over HTTP; the process that runs one plays its part."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from station.api.app import Kept, create_app
from station.client import ApiError
from station.trials.analysis import objective_as_plan
from station.trials.background_experiments import BackgroundExperiments
from station.trials.objective import Objective
from station.trials.results import Results, file_of
from station.trials.trace import Trace
from station.trials.trial import Script, Setup, Trial, TrialResult
from station.wire import ExperimentRequest
from tests.api.conftest import VIEWER

ROOT = Path(__file__).parents[3]
SCRIPT = str(ROOT / "tests" / "trials" / "experiment_script.py")
SETUP = Setup("{}")
REQUEST = ExperimentRequest(kind="sweep", controller="spring", name="some", trials=2)


@pytest.fixture(autouse=True)
def own_experiments(monkeypatch, tmp_path):
    """Begin without any experiment and gain set."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


@pytest.fixture
def part():
    """What the process does."""
    return "quick"


@pytest.fixture
def app(station, authenticator, part):
    """Return the app with experiments."""
    command = (sys.executable, SCRIPT, part)
    experiments = BackgroundExperiments(SETUP, command=command)
    yield create_app(station, authenticator, kept=Kept(experiments=experiments))
    experiments.close()


@pytest.fixture
def searched():
    """Keep a search whose second trial is the better one; return both trials."""
    script = Script(controller="spring", duration=1.0)
    first = Trial(SETUP, script, {"gains/spring/k": 2.0})
    better = first.with_parameters({"gains/spring/k": 5.0})
    plan = {
        "first": first.hash,
        "goal": objective_as_plan(Objective({"rms_error": 1.0}, ())),
        "controller": "spring",
    }
    shape = np.zeros((1000, 1))
    trace = Trace(("j",), 0.001, np.arange(1000) * 0.001, *([shape] * 6))
    with Results.create(file_of("better"), "tune", SETUP, plan) as results:
        for trial, error in ((first, 0.2), (better, 0.1)):
            metrics = {"rms_error": error}
            done = TrialResult(trial.hash, "done", None, metrics, 0.1, "w")
            results.add(trial, done)
            results.keep_recording(trial.hash, trace)
        results.set_outcome("done", "No trial was better in 15 generations.")
    return first, better


@pytest.mark.usefixtures("spring")
def test_trials_have_the_controllers_that_are_loaded_now(client):
    """Of a setup without any, the one that the station has loaded is in the trials."""
    client.experiments.start(REQUEST)

    with Results.open(file_of("some")) as results:
        found = json.loads(results.setup.text)["controllers"]["spring"]
    assert found == {"type": "test/Spring", "joint": "j", "k": 2.0}


def test_an_experiment_is_started_followed_listed_and_deleted(client):
    started = client.experiments.start(REQUEST)
    ended = client.experiments.wait("some")

    assert (started.name, started.kind, started.controller) == (
        *("some", "sweep"),
        "spring",
    )
    assert ended.state == "done"
    assert ended.best is None
    assert [one.name for one in client.experiments.list()] == ["some"]
    assert client.experiments.delete("some").name == "some"
    assert client.experiments.list() == []


@pytest.mark.parametrize("part", ["wait"])
def test_one_runs_at_a_time_and_can_be_cancelled(client):
    client.experiments.start(REQUEST)

    for ask in (
        lambda: client.experiments.start(REQUEST.model_copy(update={"name": "b"})),
        lambda: client.experiments.delete("some"),
    ):
        with pytest.raises(ApiError, match="'some' runs") as caught:
            ask()
        assert caught.value.status == 409
    client.experiments.cancel("some")

    assert client.experiments.wait("some").state == "cancelled"


@pytest.mark.parametrize("part", ["refuse"])
def test_what_the_process_refuses_has_its_status_and_words(client):
    with pytest.raises(ApiError, match="'load' cannot be -1") as caught:
        client.experiments.start(REQUEST)

    assert (caught.value.status, caught.value.code) == (422, "impossible_range")
    assert client.experiments.list() == []


def test_the_first_trial_and_the_best_are_told(client, searched):
    first, better = searched

    found = client.experiments.get("better")

    assert (found.state, found.ended, found.failed) == ("done", 2, 0)
    assert found.first.hash == first.hash
    assert (found.best.hash, found.cost) == (better.hash, 0.5)
    assert [t.number for t in client.experiments.trials("better", after=1)] == [2]
    assert [t.hash for t in client.experiments.best("better", 1)] == [better.hash]
    responses = client.experiments.responses("better")
    assert [(one.role, one.hash) for one in responses] == [
        ("first", first.hash),
        ("best", better.hash),
    ]
    assert len(responses[0].time) <= 400
    assert responses[0].joints == ["j"]


def test_gains_are_shown_put_into_force_saved_and_taken_back(spring, searched):
    preview = spring.experiments.preview("better")

    (difference,) = preview.differences
    assert (difference.name, difference.present, difference.saved) == ("k", 2.0, 5.0)
    assert spring.gains("spring").values == {"k": 2.0}
    changes = spring.experiments.apply("better", revisions=preview.revisions)
    assert changes["spring"].values == {"k": 5.0}
    assert spring.experiments.preview("better").differences == []
    assert spring.gain_sets.get("better").gains == {"spring": {"k": 5.0}}
    spring.gain_sets.undo()
    assert spring.gains("spring").values == {"k": 2.0}
    first = searched[0].hash[:6]
    assert spring.experiments.apply("better", first)["spring"].values == {"k": 2.0}


@pytest.mark.usefixtures("searched")
def test_gains_that_somebody_has_changed_meanwhile_stay(spring):
    preview = spring.experiments.preview("better")
    spring.set_gains("spring", {"k": 3.0})

    with pytest.raises(ApiError, match="changed since revision") as caught:
        spring.experiments.apply("better", revisions=preview.revisions)

    assert caught.value.status == 412
    assert spring.gains("spring").values == {"k": 3.0}
    assert spring.gain_sets.names() == []


@pytest.mark.usefixtures("searched")
def test_an_unfinished_experiment_says_so(client):
    with Results.open(file_of("better")) as results:
        results.set_outcome("running")

    assert client.experiments.get("better").state == "unfinished"


@pytest.mark.parametrize(
    ("ask", "status"),
    [
        (lambda e: e.get("nothing"), 404),
        (lambda e: e.cancel("nothing"), 404),
        (lambda e: e.cancel("better"), 409),
        (lambda e: e.delete("nothing"), 404),
        (lambda e: e.trials("nothing"), 404),
        (lambda e: e.trials("better", count=0), 422),
        (lambda e: e.best("better", metric="speed"), 422),
        (lambda e: e.preview("better", "abcd"), 404),
        (lambda e: e.preview("better"), 404),  # its controller is not loaded
        (lambda e: e.apply("better"), 404),
    ],
)
@pytest.mark.usefixtures("searched")
def test_what_is_not_possible_is_refused(client, ask, status):
    with pytest.raises(ApiError) as caught:
        ask(client.experiments)

    assert caught.value.status == status


def test_a_station_without_experiments_says_so(station, authenticator, http):
    http.headers["Authorization"] = f"Bearer {VIEWER}"
    http._transport = type(http._transport)(create_app(station, authenticator))

    answer = http.get("/api/v1/experiments")

    assert answer.status_code == 409
    assert "runs no experiments" in answer.json()["detail"]


def test_viewers_look_and_start_nothing(http):
    http.headers["Authorization"] = f"Bearer {VIEWER}"

    assert http.get("/api/v1/experiments").json()["experiments"] == []
    for path in ("", "/x/cancel", "/x/apply"):
        assert http.post(f"/api/v1/experiments{path}").status_code == 403
    assert http.delete("/api/v1/experiments/x").status_code == 403
