"""Verbs for a simulated robot."""

import json

import pytest


@pytest.mark.parametrize(
    ("line", "call", "said"),
    [
        ("pause", ("pause",), "Paused; 1.250 s simulated."),
        ("resume", ("resume",), "Running at 0.5 times real time; 1.250 s simulated."),
        ("step", ("step", 1), "Paused"),
        ("step 20", ("step", 20), "Paused"),
        ("reset", ("reset", {}), "Running"),
        ("reset --keyframe ready", ("reset", {}, "ready"), "Running"),
        ("reset j1=0.5 j2=-1e-1", ("reset", {"j1": 0.5, "j2": -0.1}), "Running"),
    ],
)
def test_verb_asks_the_station_and_says_what_came_of_it(run, station, line, call, said):
    outcome = run(line)

    assert outcome.code == 0
    assert station.calls == [call]
    assert said in outcome.out


def test_json_has_the_whole_state(run):
    assert json.loads(run("pause --json").out) == {
        "paused": True,
        "real_time_factor": 0.5,
        "time": 1.25,
        "steps_due": 0,
        "keyframes": [],
    }


@pytest.mark.parametrize("line", ["step many", "reset j1", "reset j1=x"])
def test_what_cannot_be_read_is_wrong_usage(run, station, line):
    assert run(line).code == 2
    assert station.calls == []
