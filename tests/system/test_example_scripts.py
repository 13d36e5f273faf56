"""The scripts and the notebook of `examples/` run against a station, and are short."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from tests.system.station_process import StationProcess

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
SCRIPTS = ["tune_by_step_responses", "pick_a_cube", "record_and_analyse"]
EXECUTE = """
import nbclient, nbformat
notebook = nbformat.read({path!r}, as_version=4)
nbclient.NotebookClient(notebook, timeout=300).execute()
for cell in notebook.cells:
    for output in cell.get("outputs", ()):
        print(output.get("text", ""), output.get("data", {{}}).get("text/html", ""))
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


@pytest.mark.parametrize("script", SCRIPTS)
def test_script_has_at_most_25_lines(script):
    assert len((EXAMPLES / f"{script}.py").read_text().splitlines()) <= 25


def test_notebook_is_made_of_the_scripts():
    generator = runpy.run_path(str(ROOT / "tools/generate_notebook.py"))

    assert (EXAMPLES / "station.ipynb").read_text() == generator["text"]()


@pytest.mark.slow
def test_step_responses_are_plotted(station, tmp_path):
    out = run(station, tmp_path, EXAMPLES / "tune_by_step_responses.py")

    assert re.findall(r"p = (\d+): overshoot \d", out) == ["100", "300", "600"]
    assert (tmp_path / "step_responses.png").stat().st_size > 10_000


@pytest.mark.slow
def test_cube_is_picked_in_spite_of_a_reflex(station, tmp_path):
    out = run(station, tmp_path, EXAMPLES / "pick_a_cube.py")

    assert "width of what is held: 40 mm" in out
    assert "reflex" in out
    x, y, z = map(float, re.search(r"the cube is at \[(.*)\]", out)[1].split(", "))
    assert (x, y) == pytest.approx((0.4, 0.3), abs=0.03)
    assert z == pytest.approx(0.02, abs=0.01)


@pytest.mark.slow
def test_motion_is_recorded_and_analysed(station, tmp_path):
    out = run(station, tmp_path, EXAMPLES / "record_and_analyse.py")

    cycles = int(re.match(r"(\d+) cycles, \d+ lost", out)[1])
    assert 500 < cycles <= 2501
    rows = (tmp_path / "motion.csv").read_text().splitlines()
    assert len(rows) == cycles + 1
    assert rows[0].startswith("stamp,cycle,desired/panda_joint1")


@pytest.mark.slow
def test_controllers_are_compared(station, tmp_path):
    out = run(station, tmp_path, EXAMPLES / "compare_two_controllers.py")

    found = re.findall(r"(\w+) +(\S+) +(\S+) +p = (\S+)", out)
    means = {name: (float(one), float(other)) for name, one, other, _ in found}
    assert means["rms_error"][0] < means["rms_error"][1]
    assert all(0.0 < float(p) <= 1.0 for *_, p in found)


@pytest.mark.slow
def test_notebook_runs(station, tmp_path):
    run(station, tmp_path, "-m", "station", "reset")

    code = EXECUTE.format(path=str(EXAMPLES / "station.ipynb"))
    out = run(station, tmp_path, "-c", code)

    assert "<b>Station</b>" in out
    assert "width of what is held: 40 mm" in out
    assert "tracking error: rms" in out
