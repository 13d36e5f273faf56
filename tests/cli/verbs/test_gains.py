"""Verb `gains`."""

import json

import pytest


def test_gains_are_shown_with_unit_and_range(run):
    assert run("gains show arm").out.split()[4:] == [
        *("j1/p", "600", "Nm/rad"),
        *("0", "…", "∞"),
    ]


def test_gains_can_be_json(run):
    shown = json.loads(run("gains show arm --json").out)

    assert shown["values"] == {"j1/p": 600.0}
    assert shown["schema"]["j1/p"]["unit"] == "Nm/rad"


def test_gains_are_set_together(run, station):
    outcome = run("gains set arm j1/p=500 j1/d=-1e-2")

    assert station.calls == [("set_gains", "arm", {"j1/p": 500.0, "j1/d": -0.01})]
    assert outcome.out.splitlines()[1].split() == ["j1/p", "600", "500"]


@pytest.mark.parametrize(
    "line",
    ["set arm", "show arm j1/p=1", "set arm j1/p", "set arm j1/p=x", "set arm =1"],
)
def test_wrong_changes_are_wrong_usage(run, station, line):
    assert run(f"gains {line}").code == 2
    assert station.calls == []
