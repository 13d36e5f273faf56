"""The scripts of `examples/` run against a station, and are short.

Most of them run as the cells of the notebook, which is made of them word by word.
"""

import json
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from tests.for_each import for_each
from tests.system.station_process import StationProcess

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
SCRIPTS = ["tune_by_step_responses", "pick_a_cube", "record_and_analyse"]
EXECUTE = """
import json, sys
import nbclient, nbformat
notebook = nbformat.read({path!r}, as_version=4)
for cell in notebook.cells:
    cell.source = cell.source.replace("trials=40", "trials=8")
nbclient.NotebookClient(notebook, timeout=300).execute()
shown = {{}}
for cell in notebook.cells:
    outputs = cell.get("outputs", ())
    shown[cell.id] = "".join(
        one.get("text", "") + one.get("data", {{}}).get("text/html", "")
        for one in outputs
    )
json.dump(shown, sys.stdout)
"""


@pytest.fixture(scope="module")
def station(tmp_path_factory):
    """Run a station with a cube."""
    folder = tmp_path_factory.mktemp("station")
    process = StationProcess(folder, "examples/cube.yaml", "--no-ui")
    process.told(0)
    yield process
    process.process.terminate()
    assert process.process.wait(30) == 0


def run(station, folder, *arguments):
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={**station.environment, "MPLBACKEND": "agg", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@for_each("script", SCRIPTS)
def test_script_has_at_most_25_lines(script):
    assert len((EXAMPLES / f"{script}.py").read_text().splitlines()) <= 25


def test_notebook_is_made_of_the_scripts():
    generator = runpy.run_path(str(ROOT / "tools/generate_notebook.py"))

    assert (EXAMPLES / "station.ipynb").read_text() == generator["text"]()


@pytest.fixture(scope="module")
def notebook(station, tmp_path_factory):
    """Run the notebook, whose cells are the scripts; return its folder and outputs."""
    folder = tmp_path_factory.mktemp("notebook")
    code = EXECUTE.format(path=str(EXAMPLES / "station.ipynb"))
    return folder, json.loads(run(station, folder, "-c", code))


@pytest.mark.long
def test_the_notebook_shows_the_station(notebook):
    assert "<b>Station</b>" in notebook[1]["connect"]


@pytest.mark.long
def test_step_responses_are_plotted(notebook):
    folder, shown = notebook

    found = re.findall(r"p = (\d+): overshoot \d", shown["tune_by_step_responses"])
    assert found == ["100", "300", "600"]
    assert (folder / "step_responses.png").stat().st_size > 10_000


@pytest.mark.long
def test_cube_is_picked_in_spite_of_a_reflex(notebook):
    out = notebook[1]["pick_a_cube"]

    assert "width of what is held: 40 mm" in out
    assert "reflex" in out
    x, y, z = map(float, re.search(r"the cube is at \[(.*)\]", out)[1].split(", "))
    assert (x, y) == pytest.approx((0.4, 0.3), abs=0.03)
    assert z == pytest.approx(0.02, abs=0.01)


@pytest.mark.long
def test_motion_is_recorded_and_analysed(notebook):
    folder, shown = notebook
    out = shown["record_and_analyse"]

    cycles = int(re.match(r"(\d+) cycles, \d+ lost", out)[1])
    assert 500 < cycles <= 2501
    assert "tracking error: rms" in out
    rows = (folder / "motion.csv").read_text().splitlines()
    assert len(rows) == cycles + 1
    assert rows[0].startswith("stamp,cycle,desired/panda_joint1")


@pytest.mark.long
def test_a_joint_is_tuned(notebook):
    percent = re.match(r"error (\d+)% of the first", notebook[1]["tune_a_joint"])[1]

    assert 0 < int(percent) <= 100


@pytest.mark.long
def test_controllers_are_compared(station, tmp_path):
    """It needs no running station, and is no cell of the notebook."""
    script = tmp_path / "compare_two_controllers.py"
    text = (EXAMPLES / script.name).read_text()
    script.write_text(text.replace("TRIALS = 10", "TRIALS = 4"))
    out = run(station, tmp_path, script)

    found = re.findall(r"(\w+) +(\S+) +(\S+) +p = (\S+)", out)
    means = {name: (float(one), float(other)) for name, one, other, _ in found}
    assert means["rms_error"][0] < means["rms_error"][1]
    assert all(0.0 < float(p) <= 1.0 for *_, p in found)
