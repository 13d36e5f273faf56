"""Verbs `control` and `token`."""

import json

import pytest

from station.cli.parser import parse
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


def test_a_token_is_made_and_printed_once(run, station):
    assert run("token create ada --role viewer --expires 60").out == "secret\n"
    assert station.calls == [("create", "ada", "viewer", 60.0)]


def test_tokens_are_listed_without_their_secret(run):
    assert "ada" in run("token list").out
    (token,) = json.loads(run("token list --json").out)
    assert "token" not in token


def test_a_token_is_revoked(run, station):
    run("token revoke ada")

    assert station.calls == [("revoke", "ada")]


def test_a_name_is_needed(run):
    assert run("token create").code == 2


def test_events_are_the_newest_of_all_kinds_unless_told():
    options = parse(["events"])

    assert (options.kind, options.since, options.severity) == ([], None, "info")
    assert (options.limit, options.follow) == (50, False)


def test_control_is_shown_unless_told():
    options = parse(["control"])

    assert (options.action, options.ttl, options.force) == ("show", 10.0, False)


@pytest.mark.parametrize("action", ["create", "list", "revoke"])
def test_a_token_is_an_operators_unless_told(action):
    assert parse(["token", action]).role == "operator"
