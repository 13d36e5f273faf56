"""Tables are plain when nobody looks, and pretty on a terminal."""

import json
import sys
from argparse import Namespace

from station.cli.errors import Failure, report
from station.cli.output import answer, answer_table, say, say_json, say_table
from station.wire import ControllerType


def test_columns_are_aligned(capsys):
    say_table(["name", "state"], [["a", "running"], ["longer", "-"]])

    assert capsys.readouterr().out == "name    state\na       running\nlonger  -\n"


def test_no_name_steers_the_terminal(capsys):
    say_table(["name"], [["a\x1b[2Jb\nc\u202ed"]])
    say("a\x1b]0;b\x07\nc\td é")
    report(Failure("c", "no 'a\x1b[1m'", "try\x9b2J"), as_json=False)

    told = capsys.readouterr()
    assert told.out == ("name\na\\x1b[2Jb\\nc\\u202ed\na\\x1b]0;b\\x07\nc\td é\n")
    assert told.err == "error: no 'a\\x1b[1m'\ntry\\x9b2J\n"


def test_terminal_gets_a_styled_table(capsys, monkeypatch):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)

    say_table(["name", "state"], [["[bold]a", "running"]])

    out = capsys.readouterr().out
    assert "[bold]a" in out
    assert "running" in out


def test_models_are_json_by_their_names_on_the_wire(capsys):
    model = ControllerType(type="a/B", base_class="C")
    wire = {
        "type": "a/B",
        "base_class": "C",
        "description": "",
        "parameters": [],
        "error": "",
    }

    say_json(model)
    say_json([model])
    say_json({"x": 1})

    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines == [wire, [wire], {"x": 1}]


def test_an_answer_is_lines_or_json(capsys):
    for as_json in (False, True):
        options = Namespace(json=as_json)
        assert answer(options, {"x": 1}, "one", "two") == 0
        assert answer_table(options, [], ["name"], [], "There are none.") == 0
        assert answer_table(options, ["a"], ["name"], [["a"]], "There are none.") == 0

    text, data = "one\ntwo\nThere are none.\nname\na\n", '{"x": 1}\n[]\n["a"]\n'
    assert capsys.readouterr().out == text + data
