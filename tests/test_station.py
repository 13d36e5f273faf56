"""The package has its version and `open`, and imports neither robot nor server."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import station

ROOT = Path(__file__).parents[1]


def test_version_is_that_of_the_distribution():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

    assert station.__version__ == project["version"]


def test_importing_it_imports_nothing_else():
    code = "import sys, station; sys.exit('numpy' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_other_names_do_not_exist():
    with pytest.raises(AttributeError, match="has no attribute 'close'"):
        _ = station.close


def test_package_says_that_it_is_typed():
    assert (ROOT / "station/py.typed").read_text() == ""


@pytest.mark.slow
def test_users_script_is_checked_by_mypy_strictly(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import station\n"
        "from station.client import Pose, StationClient\n"
        "from station.wire import JointStates\n"
        "with StationClient() as client, client.stream('joint_states') as stream:\n"
        "    client.move_to(Pose((0.4, 0.0, 0.4)))\n"
        "    reveal_type(stream.receive(1.0).read(JointStates).position)\n"
        "    reveal_type(client.collect(1.0)['position'])\n"
        "with station.open('x.yaml') as robot:\n"
        "    reveal_type(robot.positions())\n"
        "client.move_to(3)\n"
    )

    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path, script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )

    lines = done.stdout.splitlines()
    shown = [line.partition("type is ")[2] for line in lines if "type is" in line]
    assert shown[0].startswith('"list[')
    assert "ndarray" in shown[1]
    assert shown[2] == '"dict[str, float]"'
    errors = [line for line in lines if ": error:" in line]
    assert len(errors) == 1, done.stdout
    assert "script.py:10" in errors[0]
