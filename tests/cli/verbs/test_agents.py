"""Verbs `agents` and `mcp`."""

import json


def test_requests_of_agents_are_listed(run):
    assert "tuner" in run("agents").out
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
