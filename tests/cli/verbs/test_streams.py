"""Verb `echo`."""

import json

import pytest

from station.wire import StreamFrame


@pytest.fixture(autouse=True)
def frames(station):
    """Let the station have three frames."""
    data = {"name": ["j1"], "position": [0.123456789]}
    station.frames = [
        StreamFrame(topic="joint_states", seq=i, epoch=1, stamp=float(i), data=data)
        for i in (1, 2, 3)
    ]


def test_frames_are_printed(run):
    out = run("echo joint_states -n 1").out

    assert out == "stamp: 1.000\nname: [j1]\nposition: [0.123457]\n---\n"


def test_frames_can_be_json_lines(run):
    lines = run("echo joint_states --json").out.splitlines()

    assert [json.loads(line)["stamp"] for line in lines] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("option", "rate", "fields"),
    [
        ("", None, []),
        ("--rate 50", 50.0, []),
        ("--rate full", "full", []),
        ("--fields stamp,position", None, ["stamp", "position"]),
    ],
)
def test_rate_and_fields_reach_the_station(run, station, option, rate, fields):
    run(f"echo joint_states {option}")

    options = {"rate": rate, "fields": fields, "reconnect": False}
    assert station.calls == [("stream", "joint_states", options)]


@pytest.mark.parametrize("rate", ["0", "fast", "nan", "inf"])
def test_impossible_rate_is_wrong_usage(run, station, rate):
    assert run(f"echo joint_states --rate {rate}").code == 2
    assert station.calls == []
