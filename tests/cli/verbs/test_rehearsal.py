"""The verb that tells how a motion would end."""

import json

import pytest
from pydantic import TypeAdapter

from station.wire import Rehearsal

REPORT = {
    "outcome": "completed",
    "error": None,
    "is_at_rest": True,
    "begin_cycle": 8,
    "cycles": 900,
    "duration": 0.9,
    "wall_time": 0.05,
    "joints": [],
    "contacts": [],
    "clearances": [],
    "times": [],
    "positions": [],
    "digest": "ab",
}


def report(**changes):
    return TypeAdapter(Rehearsal).validate_python({**REPORT, **changes})


def test_path_is_rehearsed_and_its_end_is_told(run, station):
    station.rehearsal = report()
    outcome = run("rehearse --path wave --seconds 2")

    assert outcome.code == 0
    assert station.calls == [
        ("rehearse", [{"kind": "path", "path": "wave"}], 2.0, False)
    ]
    assert outcome.out == "completed after 0.900 s (900 cycles, rehearsed in 50 ms).\n"


def test_model_of_a_real_arm_is_told(run, station):
    station.rehearsal = report(twin="model")
    assert "A model of the arm was moved" in run("rehearse --path wave").out


def test_a_name_that_no_path_has_is_refused_as_it_was_typed(run, station):
    empty = run("rehearse --path=")
    assert empty.err.startswith("error: --path: must have at least 1 character")
    assert run("rehearse --path a/b").err.startswith("error: --path: must have letters")
    assert station.calls == []


def test_failed_steps_of_a_file_give_exit_code_1(run, station, tmp_path):
    error = {
        "cause": "reflex",
        "cycle": 70,
        "time": 0.06,
        "where": "panda_joint4",
        "touching": [["panda_link5", "post"]],
        "code": "joint_reflex",
        "text": "It touched something.",
        "step": 0,
    }
    station.rehearsal = report(outcome="failed", error=error)
    steps = [{"kind": "switch", "start": ["arm"]}]
    (tmp_path / "steps.json").write_text(json.dumps(steps))
    outcome = run(f"rehearse --file {tmp_path / 'steps.json'} --certificate")

    assert outcome.code == 1
    assert station.calls == [("rehearse", steps, None, True)]
    assert "reflex at panda_joint4 in cycle 70: It touched something." in outcome.out
    assert "Touching: panda_link5 and post." in outcome.out


@pytest.mark.parametrize(
    "words", ["arm ready --path wave", "arm --file s.json", "--path w --file s.json"]
)
def test_two_things_to_rehearse_are_refused(run, station, words):
    outcome = run(f"rehearse {words}")

    assert (outcome.code, station.calls) == (2, [])
    assert "was named twice" in outcome.err


def test_nothing_to_rehearse_is_refused(run, station, tmp_path):
    assert run("rehearse").code == 2
    file = tmp_path / "steps.json"
    for text in ("[]", "{}", "[1]"):
        file.write_text(text)
        outcome = run(f"rehearse --file {file}")
        assert (outcome.code, station.calls) == (2, [])
        assert f"{file} holds no list of steps." in outcome.err
