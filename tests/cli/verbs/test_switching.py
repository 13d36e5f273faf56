"""Verbs that start and stop controllers."""

import json

import pytest


def request(station) -> dict:
    (call,) = [call for call in station.calls if call[0] == "switch"]
    return call[1]


def test_switch_says_what_it_did(run, station):
    outcome = run("switch_controllers --activate leg --deactivate arm")

    assert outcome.code == 0
    assert outcome.out == (
        "Stopped: arm.\nStarted: leg.\nLargest jump of a command: 0.25 at j2.\n"
    )
    assert request(station) == {
        "start": ["leg"],
        "stop": ["arm"],
        "strictness": "strict",
        "start_asap": False,
        "timeout": 0.0,
        "bound": 5.0,
        "dry_run": False,
    }


def test_options_reach_the_station(run, station):
    line = "--best-effort --activate-asap --switch-timeout 2.5 --dry-run"

    outcome = run(f"switch-controllers --activate leg {line}")

    assert outcome.out.startswith("Would have started: leg.")
    asked = request(station)
    assert asked["strictness"] == "best_effort"
    assert (asked["start_asap"], asked["timeout"], asked["dry_run"]) == (
        True,
        2.5,
        True,
    )


@pytest.mark.parametrize(
    ("written", "asked"),
    [
        ("", {"bound": 5.0}),
        ("--switch-bound 30", {"bound": 30.0}),
        ("--switch-bound inf", {"bound": None}),
    ],
)
def test_the_bound_of_a_switch_reaches_the_station(run, station, written, asked):
    run(f"switch-controllers --activate leg {written}")

    assert {k: v for k, v in request(station).items() if k == "bound"} == asked


@pytest.mark.parametrize(
    ("outcome", "told"),
    [
        ("rolled_back", "Rolled back: what ran before runs again."),
        ("halted", "Halted: the hardware carried out neither the switch"),
    ],
)
def test_a_switch_that_was_not_committed_says_how_it_ended(run, station, outcome, told):
    station.outcome = outcome

    answer = run("switch_controllers --activate leg")

    assert answer.code == 1
    assert told in answer.out


def test_switch_of_nothing_is_wrong_usage(run, station):
    outcome = run("switch_controllers")

    assert outcome.code == 2
    assert "--activate" in outcome.err
    assert station.calls == []


def test_switch_can_be_json(run):
    result = json.loads(run("switch_controllers --activate leg --json").out)

    assert (result["started"], result["cycle"]) == (["leg"], 7)


def test_controller_that_does_not_run_is_told(run, station):
    station.failed = {"leg": "its starting raised ValueError."}

    outcome = run("switch_controllers --activate leg")

    assert outcome.code == 1
    assert "leg does not run: its starting raised ValueError." in outcome.out


def test_start_starts(run, station):
    run("start leg hand")

    assert request(station) == {"start": ["leg", "hand"]}


def test_spawn_loads_and_starts(run, station):
    run("spawn hand")

    assert station.calls == [
        ("load", "hand", None, None),
        ("switch", {"start": ["hand"]}),
    ]


def test_kill_stops_what_runs_and_unloads(run, station):
    outcome = run("kill arm leg")

    assert outcome.code == 0
    assert station.calls == [
        ("switch", {"stop": ["arm"]}),
        ("unload", "arm"),
        ("unload", "leg"),
    ]


@pytest.mark.parametrize(("names", "stopped"), [("arm leg", ["arm"]), ("leg", [])])
def test_kill_lists_what_it_unloaded_as_json(run, names, stopped):
    told = json.loads(run(f"kill {names} --json").out)

    assert (told["ok"], told["stopped"]) == (True, stopped)
    assert told["unloaded"] == names.split()


def test_a_controller_is_brought_into_a_state_by_one_step(run, station):
    assert run("set_controller_state leg active").code == 0
    assert station.calls[-1][1]["start"] == ["leg"]
    assert run("set_controller_state arm inactive").code == 0
    assert station.calls[-1][1]["stop"] == ["arm"]
    assert run("set_controller_state leg unconfigured").code == 0
    assert station.calls[-1] == ("unload", "leg")
    assert run("set_controller_state hand inactive").out == "hand is inactive.\n"
    assert station.calls[-1][:2] == ("load", "hand")
    outcome = run("set_controller_state arm unconfigured")
    assert outcome.code == 2
    assert "'arm' is active" in outcome.err
