"""Every shell example works: curl and `station` lines run against a real station."""

import calendar
import re
import sys
from pathlib import Path

import httpx
import pytest

from station.api.app import Kept, create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.app.composition import compose
from station.cli import main, normalise
from station.cli.parser import parse
from station.client import StationClient
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.records.record_store import RecordStore
from station.records.recorder import Recorder
from station.trials.background_experiments import BackgroundExperiments
from station.trials.results import Results, file_of
from station.trials.trial import Script, Setup, Trial, TrialResult
from tests.api.spring import make_station
from tests.documentation.shell_examples import (
    EVERY_ROUTE,
    PAGES,
    ROOT,
    commands,
    curl_request,
)
from tests.for_each import for_each
from tests.waiting import PATIENCE, wait_until

OPERATOR = "operator-token"
TRIED = [
    ROOT / "README.md",
    ROOT / "docs" / "api.md",
    ROOT / "docs" / "controllers.md",
    EVERY_ROUTE,
]
ENDLESS = {"run", "ui", "doctor"}
"""Verbs that are not tried: they last, or look at the machine."""
LASTING = {"--follow", "take"}
"""Words that let other verbs last until Ctrl-C."""
FILES: dict[str, bytes] = {}
"""The files that examples have made, and later ones send."""
VERBS = [
    command
    for page in PAGES
    for command in commands(page)
    if command.words[0] == "station"
]


def keep_an_incident(incidents):
    """Stop another station, so that there is an incident."""
    station = make_station()
    recorder = Recorder(station, RecordStore(incidents.folder.parent), incidents)
    station.stop("for the examples")
    station.loop.step(2_100)  # an incident lasts until 2 s after its cause
    recorder.close()


def keep_an_experiment(setup):
    """Keep the experiment `stiffer` with one trial."""
    name = "effort_group_position_controller"
    trial = Trial(
        setup,
        Script(controller=name, duration=1.0),
        {f"gains/{name}/panda_joint7/p": 60.0},
    )
    result = TrialResult(trial.hash, "done", None, {"rms_error": 0.1}, 0.1, "w")
    with Results.create(file_of("stiffer"), "sweep", setup, {}) as results:
        results.add(trial, result)


@pytest.fixture
def url(tmp_path, monkeypatch):
    """Serve the station of the default configuration; return its address.

    Recordings and incidents have the names that the pages give as examples.
    """
    config = load_config()
    station = compose(config).station
    begin = calendar.timegm((2026, 11, 22, 9, 15, 0)) + 0.1235
    incidents = RecordStore(tmp_path / "incidents", now=lambda: begin)
    keep_an_incident(incidents)
    store = RecordStore(tmp_path / "recordings", now=lambda: begin)
    recorder = Recorder(station, store, incidents)
    recorder.start_thread()
    station.loop.start()
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    keep_an_experiment(Setup.of(config))
    command = (sys.executable, str(ROOT / "tests/trials/experiment_script.py"), "wait")
    experiments = BackgroundExperiments(Setup.of(config), command=command)
    kept = Kept(recorder=recorder, experiments=experiments)
    app = create_app(station, Authenticator(OPERATOR), kept=kept)
    try:
        station.switch_controllers(SwitchRequest(start=config.start))
        with ApiServer(app, port=0) as server:
            yield server.url
    finally:
        experiments.close()
        station.loop.stop()
        recorder.close()


@pytest.mark.slow
@pytest.mark.parametrize("page", TRIED, ids=lambda page: page.name)
def test_examples_of_the_page_work_in_their_order(page, url, monkeypatch, capsys):
    monkeypatch.setenv("STATION_URL", url)
    monkeypatch.setenv("STATION_TOKEN", OPERATOR)
    variables = {
        "API": f"{url}/api/v1",
        "TOKEN": OPERATOR,
        "AUTH": f"Authorization: Bearer {OPERATOR}",
        "LEASE": "",
    }
    tried = 0

    if page.name == "README.md":  # who reads on from there has typed this first
        exec(python_of(page), {})
    for command in commands(page, variables):
        if command.words[0] == "curl":
            answer = send(command.words)
            expected = {command.status or 200}
            assert answer.status_code in expected, f"{command.text}: {answer.text}"
            if answer.status_code == 201 and "id" in answer.json():
                variables["GOAL"] = answer.json()["id"]
            if answer.status_code == 200 and answer.text.startswith("{"):
                variables["LEASE"] = answer.json().get("lease") or variables["LEASE"]
        elif command.words[0] == "station" and not is_lasting(command.words):
            code = main(command.words[1:])
            assert code == 0, f"{command.text}: {capsys.readouterr().err}"
        else:
            continue
        tried += 1

    assert tried


def python_of(page: Path) -> str:
    """Return the only example in Python of a page."""
    text = page.read_text()
    (example,) = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    return example


def is_lasting(words: list[str]) -> bool:
    return words[1] in ENDLESS or not LASTING.isdisjoint(words)


def send(words: list[str]) -> httpx.Response:
    request = curl_request(words)
    body = request.body
    if body is not None and body.startswith("@"):
        body = FILES[body[1:]]
    answer = httpx.request(
        request.method,
        request.url,
        headers=request.headers,
        content=body,
        timeout=PATIENCE,
    )
    if request.output:
        FILES[request.output] = answer.content
    return answer


@for_each("command", VERBS, ids=lambda command: command.text)
def test_the_command_line_understands_the_example(command):
    assert parse(normalise(command.words[1:])).run


@pytest.mark.long
def test_the_square_of_the_page_on_controllers_is_driven(url, monkeypatch):
    monkeypatch.setenv("STATION_URL", url)
    monkeypatch.setenv("STATION_TOKEN", OPERATOR)
    names: dict[str, object] = {}

    exec(python_of(ROOT / "docs" / "controllers.md"), names)

    with StationClient(url, OPERATOR) as client:
        wanted = pytest.approx(names["pose"], abs=2e-3)

        def actual():
            return client.controller_state("cartesian_streaming_controller").actual

        assert wait_until(lambda: actual() == wanted)  # the end of the way
