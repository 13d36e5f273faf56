"""Verb `gains`."""

import json

import pytest

from station.cli.parser import parse


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
    [
        *("set arm", "show arm j1/p=1", "set arm j1/p", "set arm j1/p=x", "set arm =1"),
        *("export", "show arm --file x.yaml"),
        *("show", "save", "list arm", "undo arm", "diff", "load", "delete a b"),
    ],
)
def test_wrong_changes_are_wrong_usage(run, station, line):
    assert run(f"gains {line}").code == 2
    assert station.calls == []


EXPORTED = "arm: {gains: {j1: {p: 500.0}}}\n"


def test_the_configuration_is_printed_or_json(run):
    assert run("gains export arm").out == EXPORTED
    assert json.loads(run("gains export arm --json").out) == {"config": EXPORTED}


def test_a_file_has_all_named_controllers_once(run, tmp_path):
    file = tmp_path / "tuned.yaml"

    outcome = run(f"gains export arm hand arm --file {file}")

    assert file.read_text() == EXPORTED + EXPORTED.replace("arm", "hand")
    assert outcome.out == f"Wrote {file}.\n"


def test_the_file_before_is_kept(run, tmp_path):
    file = tmp_path / "tuned.yaml"
    file.write_text("# mine\n")

    outcome = run(f"gains export arm --file {file}")

    assert file.read_text() == EXPORTED
    assert (tmp_path / "tuned.yaml~").read_text() == "# mine\n"
    assert outcome.out.splitlines()[1] == f"The file before is {file}~."
    assert sorted(p.name for p in tmp_path.iterdir()) == ["tuned.yaml", "tuned.yaml~"]


def test_a_file_that_cannot_be_written_costs_nothing(run, tmp_path):
    outcome = run(f"gains export arm --file {tmp_path}/missing/tuned.yaml")

    assert outcome.code == 2
    assert "missing/tuned.yaml cannot be written: No such file" in outcome.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("line", "call", "words"),
    [
        ("save stiff", ("save", "stiff", None), "Saved 1 gain of arm."),
        ("save stiff arm", ("save", "stiff", ["arm"]), "Saved 1"),
        ("load stiff", ("apply", "stiff", None), "j1/p  5       600"),
        ("load stiff arm", ("apply", "stiff", ["arm"]), "j1/p  5       600"),
        ("diff stiff", ("get_set", "stiff"), "j1/p  600    5"),
        ("delete stiff", ("delete_set", "stiff"), "Deleted the gain set stiff."),
        ("undo", ("undo",), "j1/p  5       600"),
    ],
)
def test_gain_sets_are_saved_loaded_compared_and_undone(
    run, station, line, call, words
):
    outcome = run(f"gains {line}")

    assert outcome.code == 0
    assert station.calls == [call]
    assert words in outcome.out
    assert "j1/d" not in outcome.out
    assert json.loads(run(f"gains {line} --json").out)


def test_gain_sets_are_listed(run):
    assert run("gains list").out.split() == ["soft", "stiff"]
    assert json.loads(run("gains list --json").out) == ["soft", "stiff"]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("gains save stiff arm leg", ["arm", "leg"]),
        ("gains set arm j1/p=5", ["j1/p=5"]),
        ("gains list", []),
    ],
)
def test_gains_takes_a_name_and_words(line, words):
    assert parse(line.split()).words == words


def test_an_unknown_action_gets_the_nearest(capsys):
    with pytest.raises(SystemExit):
        parse(["gains", "sav", "x"])
    assert "Did you mean 'save'" in capsys.readouterr().err
