"""Verb `parameters`."""

import json

import pytest


@pytest.mark.parametrize(
    ("line", "call", "out"),
    [
        ("get", ("parameter", ""), {"p": 1.0}),
        ("get arm/gains", ("parameter", "arm/gains"), {"p": 1.0}),
        ("delete arm/p", ("delete_parameter", "arm/p"), 3),
    ],
)
def test_parameters_are_printed_as_json(run, station, line, call, out):
    assert json.loads(run(f"parameters {line}").out) == out
    assert station.calls == [call]


@pytest.mark.parametrize(
    ("word", "value"),
    [("0.5", 0.5), ("[1,2]", [1, 2]), ("true", True), ("panda", "panda"), ("1e", "1e")],
)
def test_a_value_is_json_or_text(run, station, word, value):
    assert run(f"parameters set arm/p {word}").out == "Done.\n"
    assert station.calls == [("set_parameter", "arm/p", value)]


@pytest.mark.parametrize("line", ["set arm/p", "delete", "get a b", "delete / ", "set"])
def test_wrong_words_are_wrong_usage(run, station, line):
    assert run(f"parameters {line}").code == 2
    assert station.calls == []
