"""Verb `events`."""

import json
from dataclasses import asdict

import pytest

from station.wire import Event, StreamFrame


def event(number, kind="stop", severity="warning", who="ada"):
    return Event(
        id=number,
        time=1000.25,
        stamp=1.0,
        cycle=1000,
        kind=kind,
        severity=severity,
        who=who,
        where="127.0.0.1",
        text=f"event {number}",
    )


@pytest.fixture(autouse=True)
def happened(station):
    """Let the station have two events, and a stream with a known and a new one."""
    station.happened = [event(1), event(2)]
    station.frames = [
        StreamFrame(topic="events", seq=e.id, epoch=1, stamp=1.0, data=asdict(e))
        for e in (event(2), event(3), event(4, "fault", "error"))
    ]


def test_events_are_printed_with_who_and_where(run):
    out = run("events").out

    assert out.count("\n") == 2
    assert "event 1 [ada (127.0.0.1)]" in out


def test_events_can_be_json_lines(run):
    lines = run("events --json").out.splitlines()

    assert [json.loads(line)["id"] for line in lines] == [1, 2]


def test_options_reach_the_station(run, station):
    run("events --since 7 --kind stop --kind fault --severity error -n 5")

    options = {"kinds": ["stop", "fault"], "severity": "error", "limit": 5}
    assert station.calls == [("events", 7, options)]


def test_following_prints_each_event_once(run):
    out = run("events --follow").out

    assert [line.split()[0] for line in out.splitlines()] == ["1", "2", "3", "4"]


def test_following_leaves_out_what_is_not_wanted(run):
    out = run("events -f --kind fault").out

    assert out.splitlines()[-1].split()[0] == "4"
    assert "event 3" not in out
