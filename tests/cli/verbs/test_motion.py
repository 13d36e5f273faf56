"""Verbs that move the robot or keep it from moving."""

import json

import pytest

from station.client import StationUnreachableError


def test_command_sends_the_set_point(run, station):
    outcome = run("command arm 0.1 -2 -3e-1")

    assert outcome.code == 0
    assert station.calls == [("command", "arm", [0.1, -2.0, -0.3])]


def test_stop_stops_the_robot(run, station):
    outcome = run("stop --reason test")

    assert station.calls == [("stop", "test")]
    assert "station release" in outcome.out


def test_stop_with_loaded_controllers_stops_these_alone(run, station):
    assert run("stop arm leg").code == 0
    assert station.calls == [("controllers",), ("switch", {"stop": ["arm"]})]


def test_stop_with_any_other_word_stops_the_robot(run, station):
    run("stop now")

    assert station.calls == [("controllers",), ("stop", "now")]


@pytest.mark.parametrize(
    "failure",
    [StationUnreachableError("http://x", OSError("refused")), ValueError("odd answer")],
)
def test_stop_is_sent_even_when_the_list_fails(run, station, failure):
    def fail():
        station.calls.append(("controllers",))
        raise failure

    station.controllers = fail

    assert run("stop arm").code == 0
    assert station.calls == [("controllers",), ("stop", "arm")]


def test_release_takes_two_steps(run, station):
    first, second = run("release"), run("release --arm")

    assert station.calls == [("release", False), ("release", True)]
    assert "nothing moves yet" in first.out
    assert "Motion is possible" in second.out


def test_stop_state_can_be_json(run):
    assert json.loads(run("stop --json").out)["state"] == "stopped"


def test_recover_takes_all_arms_at_once(run, station):
    outcome = run("recover")

    assert station.calls == [("recover_all", "none")]
    assert outcome.out.splitlines() == [
        "left is idle.",
        "right is idle.",
        "Started again: nothing.",
    ]


def test_recover_of_all_arms_can_start_controllers_again(run, station):
    outcome = run("recover --restart")

    assert station.calls == [("recover_all", "previous")]
    assert "Started again: arm." in outcome.out


def test_recover_can_start_controllers_again(run, station):
    outcome = run("recover right --restart")

    assert station.calls == [("recover", "right", "previous")]
    assert "Started again: arm." in outcome.out
