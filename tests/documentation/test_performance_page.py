"""The tables of the performance page are complete, and can be written anew."""

import re
import runpy

import pytest

from tests.documentation.shell_examples import ROOT

PAGE = ROOT / "docs" / "performance.md"
SCRIPT = ROOT / "benchmarks" / "write_tables.py"
PLACE = re.compile(r"^<!-- (\w+) -->\n(.*?)^<!-- end of \1 -->$", re.M | re.S)


@pytest.fixture
def script(monkeypatch):
    """Return the functions that write tables."""
    monkeypatch.syspath_prepend(str(SCRIPT.parent))
    return runpy.run_path(str(SCRIPT), run_name="not_run")


def test_every_table_has_its_place():
    tables = dict(PLACE.findall(PAGE.read_text()))

    names = "machine cycles robots model peers jitter dashboard batch"
    assert set(tables) == set(names.split())
    assert "hot, compiled" in tables["cycles"]
    assert "robosuite" in tables["peers"]


def test_a_table_is_replaced_and_nothing_else(script, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- t -->\nold\n<!-- end of t -->\nb\n")
    text = script["table"](["x", "y"], [[1, "2"]])

    script["write"](page, "t", text)
    script["write"](page, "t", text)

    rows = "| x | y |\n| --- | --- |\n| 1 | 2 |"
    assert page.read_text() == f"a\n<!-- t -->\n{rows}\n<!-- end of t -->\nb\n"


def test_a_table_without_a_place_is_an_error(script, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("nothing\n")

    with pytest.raises(ValueError, match="0 places"):
        script["write"](page, "t", "text")


def test_figures_are_medians_of_runs(script):
    runs = [[{"name": "a", "ratio": value}] for value in (3.0, 1.0, 2.0)]

    assert script["medians"](runs) == [{"name": "a", "ratio": 2.0}]


def test_a_robot_has_its_first_and_last_row(script):
    labels = [("arm", "none"), ("arm", "a"), ("arm", "b"), ("base", "none")]

    assert script["ends"](labels) == [labels[0], labels[2], labels[3]]
