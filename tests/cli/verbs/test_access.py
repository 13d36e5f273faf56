"""Verbs `control` and `token`."""

import json
import os
import signal
from argparse import Namespace

import pytest

from station.cli.parser import parse
from station.cli.verbs import access
from station.client import ApiError
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


@pytest.fixture
def served(monkeypatch, station):
    """Return the tokens with which agents were served."""
    found = []

    async def serve(_, token, *__):
        found.append(token)

    monkeypatch.setattr("station.mcp.server.serve", serve)
    station.session = lambda: Namespace(role="operator")
    return found


def test_requests_of_agents_are_listed(run):
    listed = run("agents").out
    assert "tuner" in listed
    assert '{"width": 0.04}' in listed  # what a person would allow
    (request,) = json.loads(run("agents --json").out)
    assert (request["number"], request["verdict"]) == ("q3TZ", None)


def test_a_request_is_answered(run, station):
    assert run("agents allow q3TZ").out == "It is allowed.\n"
    run("agents allow-for-10-min q3TZ")
    run("agents refuse q3TZ")
    verdicts = ["allowed", "allowed_for_a_time", "refused"]
    assert station.calls == [("answer", "q3TZ", verdict) for verdict in verdicts]


def test_an_answer_needs_a_number(run):
    assert run("agents allow").code == 2


def test_an_agent_is_served_with_a_token_for_the_time_that_it_runs(
    run, station, served
):
    assert run("mcp --name tuner").err == "The agent is called tuner.\n"
    assert served == ["secret"]
    assert station.calls == [("create", "tuner", "agent", None), ("revoke", "tuner")]


def test_an_agent_whose_name_is_taken_gets_a_similar_one(
    run, station, served, monkeypatch
):
    create = station.tokens.create

    def taken(name, role):
        if name == "tuner":
            raise ApiError("It is taken.", status=409, code="token_exists")
        return create(name, role)

    monkeypatch.setattr(station.tokens, "create", taken)
    outcome = run("mcp --name tuner")
    assert outcome.code == 0
    assert outcome.err.startswith("The agent is called tuner-")
    assert served == ["secret"]
    (_, name, *_), revoked = station.calls
    assert revoked == ("revoke", name)


def test_the_token_of_an_agent_that_is_killed_is_revoked(tmp_path, monkeypatch):
    told = tmp_path / "told"
    command = tmp_path / "python"
    command.write_text(f'#!/bin/sh\necho "$STATION_URL $STATION_TOKEN $@" > {told}\n')
    command.chmod(0o755)
    monkeypatch.setattr("sys.executable", str(command))
    # A process that is killed closes its end of the pipe, and does nothing else.
    with access._start_heir("http://h:1", "secret", None, "tuner") as heir:
        assert heir.poll() is None
    assert told.read_text() == "http://h:1 secret -m station token revoke tuner\n"


def test_an_agent_that_is_terminated_leaves_no_token(run, station, monkeypatch):
    class Ended(BaseException):
        """What ends the process, here without ending it."""

    def exit_at_once(code):
        station.calls.append(("exit", code))
        raise Ended

    async def serve(*_):
        os.kill(os.getpid(), signal.SIGTERM)

    station.session = lambda: Namespace(role="operator")
    monkeypatch.setattr("station.mcp.server.serve", serve)
    monkeypatch.setattr(os, "_exit", exit_at_once)
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(Ended):
        run("mcp --name tuner")
    assert station.calls[1:3] == [("revoke", "tuner"), ("exit", 143)]
    assert signal.getsignal(signal.SIGTERM) is before
