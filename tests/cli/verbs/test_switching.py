"""Verbs that start and stop controllers."""

import json


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
