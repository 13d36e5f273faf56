"""Verb `control`."""

import json

from station.wire import ControlState


def test_it_says_who_holds_control(run, station):
    assert "Nobody" in run("control").out
    station.control_found = ControlState(
        owner="Ada", since=0.0, hand_over_to="Grace", ttl=10.0
    )

    out = run("control show").out
    assert out.startswith("Ada holds control since")
    assert "offered to Grace" in out
    assert json.loads(run("control --json").out)["owner"] == "Ada"


def test_it_is_taken_until_it_is_lost(run, station):
    done = run("control take --owner Ada --ttl 5 --force")

    assert done.code == 1
    assert "Grace holds control" in done.err
    assert "STATION_CONTROL_LEASE=key" in done.out
    assert station.calls == [("control", "Ada", {"ttl": 5.0, "force": True})]


def test_verbs_act_under_the_lease_of_the_environment(run, station, monkeypatch):
    monkeypatch.setenv("STATION_CONTROL_LEASE", "key")
    run("control release")

    assert station.acts_under == "key"
    assert station.calls == [("release",)]
