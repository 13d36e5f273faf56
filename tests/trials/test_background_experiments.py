"""A station's experiments: one at a time, followed, cancelled, and never outliving it.

The process is a script that plays the part of an experiment.
"""

import queue
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from station.trials.background_experiments import (
    MOST_TRIALS,
    BackgroundExperiments,
    spare_processors,
)
from station.trials.errors import (
    ExperimentError,
    ExperimentNotFoundError,
    ExperimentRunningError,
    ImpossibleRangeError,
    TooManyExperimentsError,
)
from station.trials.results import Results, file_of, names
from station.trials.trial import Setup
from station.wire.experiments import ExperimentRequest
from tests.waiting import PATIENCE, wait_until

ROOT = Path(__file__).parents[2]
SCRIPT = str(Path(__file__).with_name("experiment_script.py"))
REQUEST = ExperimentRequest(kind="sweep", controller="arm", name="some", trials=2)


@pytest.fixture(autouse=True)
def own_experiments(monkeypatch, tmp_path):
    """Begin without any experiment."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


@pytest.fixture
def make(tmp_path):
    """Return a function that returns experiments whose processes play a part."""
    made, empty = [], tmp_path / "empty"
    plan = {"trials": REQUEST.trials, "controller": REQUEST.controller}
    Results.create(empty, REQUEST.kind, Setup("{}"), plan).close()

    def make(part):
        file = file_of(REQUEST.name)
        file.parent.mkdir(parents=True, exist_ok=True)
        command = (sys.executable, "-S", SCRIPT, part, str(file), str(empty))
        background = BackgroundExperiments(Setup("{}"), command=command)
        background.told = queue.Queue()
        background.tell = background.told.put
        made.append(background)
        return background

    yield make
    for background in made:
        background.close()


def until_it_ends(background):
    """Return all states until the experiment does not run any more."""
    states = [background.told.get(timeout=PATIENCE)]
    while states[-1].state == "running":
        states.append(background.told.get(timeout=PATIENCE))
    return states


def test_an_experiment_is_followed_to_its_end(make):
    background = make("quick")

    assert background.start(REQUEST, {}) == "some"

    states = until_it_ends(background)
    assert [(s.state, s.ended) for s in states] == [
        ("running", 0),
        ("running", 1),
        ("running", 2),
        ("done", 2),
    ]
    assert background.state == states[-1]
    assert states[-1].reason == "No trial was better in 15 generations."


def test_what_the_process_refuses_is_refused_word_by_word(make):
    background = make("refuse")

    with pytest.raises(ImpossibleRangeError, match="'load' cannot be -1") as caught:
        background.start(REQUEST, {})

    assert caught.value.remedy == "Choose more."
    assert caught.value.details == {"parameter": "load"}
    assert background.state is None
    assert names() == []


def test_a_killed_process_is_told_with_its_signal(make):
    background = make("die")

    background.start(REQUEST, {})

    last = until_it_ends(background)[-1]
    assert (last.state, last.ended) == ("failed", 1)
    assert "killed by SIGKILL" in last.reason
    background.start(REQUEST, {})  # the way is free again
    until_it_ends(background)


def test_a_process_that_the_station_kills_is_not_said_to_be_killed_by_others(make):
    background = make("linger")

    background.start(REQUEST, {})

    last = until_it_ends(background)[-1]
    assert last.state == "failed"
    assert "did not end, so the station killed it" in last.reason


def test_a_process_that_never_begins_is_told_with_its_exit_code(make):
    with pytest.raises(ExperimentError, match=r"before it began: exit code 7\."):
        make("silent").start(REQUEST, {})


def test_a_program_that_there_is_not_is_told():
    background = BackgroundExperiments(Setup("{}"), command=("/nowhere/python",))

    with pytest.raises(ExperimentError, match="/nowhere/python"):
        background.start(REQUEST, {})


def test_one_runs_at_a_time_until_it_is_cancelled(make):
    background = make("wait")
    background.start(REQUEST, {})

    with pytest.raises(ExperimentRunningError, match="'some' runs; a station runs one"):
        background.start(REQUEST.model_copy(update={"name": "other"}), {})
    with pytest.raises(ExperimentRunningError, match="'some' runs"):
        background.delete("some")
    background.cancel("some")

    assert until_it_ends(background)[-1].state == "cancelled"
    with pytest.raises(ExperimentRunningError, match="'some' does not run"):
        background.cancel("some")
    background.delete("some")
    with pytest.raises(ExperimentNotFoundError):
        background.cancel("some")


def test_too_many_trials_are_refused(make):
    request = REQUEST.model_copy(update={"trials": MOST_TRIALS + 1})

    with pytest.raises(TooManyExperimentsError, match="runs 10000 at most"):
        make("quick").start(request, {})


def test_too_many_experiments_are_refused(make, monkeypatch):
    monkeypatch.setattr("station.trials.background_experiments.MOST_EXPERIMENTS", 1)
    background = make("quick")
    file_of("old").touch()

    with pytest.raises(TooManyExperimentsError, match="allowed are 1"):
        background.start(REQUEST, {})


def test_a_station_lends_one_processor_at_least():
    assert spare_processors() >= 1


@pytest.mark.slow
def test_processes_and_workers_end_with_a_station_that_is_killed():
    """The station is a program that starts an experiment and is killed meanwhile."""
    program = """
        import glob, time
        from station.trials.background_experiments import BackgroundExperiments
        from station.trials.trial import Setup
        from station.wire.experiments import ExperimentRequest
        from station.trials.results import Results, file_of

        experiments = BackgroundExperiments(Setup.load())
        request = ExperimentRequest(
            kind="sweep", controller="effort_group_position_controller",
            name="some", ranges=["load=0:1"], trials=1000,
        )
        experiments.start(request, {})
        while experiments.state.ended < 1:
            time.sleep(0.05)
        found = []
        def walk(pid):
            for task in glob.glob(f"/proc/{pid}/task/*/children"):
                for child in open(task).read().split():
                    found.append(child)
                    walk(child)
        walk("self")
        print(*found, flush=True)
        time.sleep(600)
    """
    station = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)],
        stdout=subprocess.PIPE,
        text=True,
    )
    with station:
        processes = [Path(f"/proc/{pid}") for pid in station.stdout.readline().split()]
        niceness = processes[0].joinpath("stat").read_text().rpartition(")")[2].split()
        station.kill()

    assert len(processes) >= 2
    assert niceness[16] == "10"
    assert wait_until(lambda: not any(map(_lives, processes)))


def _lives(process):
    try:
        return process.joinpath("stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
